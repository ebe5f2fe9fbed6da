// SPDX-License-Identifier: Apache-2.0
// Columns hold what a list of structs would.
#include "core/math/columns.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace tessera::core {
namespace {

struct Particle {
  Vec3 position{};
  std::uint32_t id = 0;
  float mass = 0;

  bool operator==(const Particle&) const = default;
};

Particle particle(std::uint32_t id) {
  const auto x = static_cast<float>(id);
  return {{x, -x, 0.5f * x}, id, 2 * x};
}

Columns<Particle> particles(std::uint32_t count) {
  Columns<Particle> columns;
  for (std::uint32_t id = 0; id < count; ++id) columns.push(particle(id));
  return columns;
}

TEST(Columns, KeepRowsAsTheyGrow) {
  const Columns<Particle> columns = particles(1000);
  ASSERT_EQ(columns.size(), 1000u);
  for (std::uint32_t id = 0; id < 1000; ++id) ASSERT_EQ(columns[id], particle(id));
  const Columns<Particle> copied(columns.all().rows(100, 50));
  for (std::uint32_t i = 0; i < 50; ++i) ASSERT_EQ(copied[i], particle(100 + i));
}

TEST(Columns, KeepAllBits) {
  Columns<Particle> columns(1);
  const Particle odd{{-0.0f, std::numeric_limits<float>::infinity(), 1e-45f}, 0xff800001u, 1};
  columns.set(0, odd);
  EXPECT_EQ(columns[0], odd);
  EXPECT_TRUE(std::signbit(columns[0].position.x));
}

TEST(Columns, OfANewListAreZero) {
  const Columns<Particle> columns(100);
  for (std::size_t i = 0; i < columns.size(); ++i) ASSERT_EQ(columns[i], Particle());
}

TEST(Columns, OfAFieldChangeNothingElse) {
  Columns<Particle> columns = particles(20);
  columns.all().field(&Particle::position).field(&Vec3::y).set(7, 40.0f);
  columns.all().field(&Particle::id).set(7, 41u);
  EXPECT_EQ(columns[7], (Particle{{7, 40, 3.5f}, 41, 14}));
  EXPECT_EQ(columns[6], particle(6));
  EXPECT_EQ(columns[8], particle(8));
}

TEST(Columns, CanBeOfASingleRow) {
  SingleRow single(particle(3));
  EXPECT_EQ(single.all()[0], particle(3));
  single.all().field(&Particle::mass).set(0, 5.0f);
  EXPECT_EQ(single.row(), (Particle{{3, -3, 1.5f}, 3, 5}));
}

TEST(Columns, AreReadInLanes) {
  const Columns<Particle> columns = particles(100);
  WordLanes rows;
  for (std::uint32_t lane = 0; lane < kLaneCount; ++lane) rows.set(lane, (37 * lane + 5) % 100);
  const RowLanes<Particle> lanes(columns.all(), rows);
  const Vec3Lanes positions(lanes.all(&Particle::position));
  const WordLanes ids(lanes.all(&Particle::id));
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
    const Particle expected = particle(rows[lane]);
    EXPECT_EQ(lanes[lane], expected);
    EXPECT_EQ(positions[lane], expected.position);
    EXPECT_EQ(ids[lane], expected.id);
    EXPECT_EQ(lanes.get(&Particle::mass, lane), expected.mass);
    EXPECT_EQ(lanes.at(lane).get(&Particle::position), expected.position);
  }
  const RowLanes<Particle> some = lanes.filled(0b110, 2);
  EXPECT_EQ(some[0], lanes[2]);
  EXPECT_EQ(some[1], lanes[1]);
}

// Every set of lanes, each after the rows of the one before.
TEST(Columns, GrowByTheLanesOfASet) {
  Columns<Particle> columns;
  std::vector<Particle> expected;
  for (unsigned set = 0; set < 1u << kLaneCount; ++set) {
    WordLanes ids;
    FloatLanes masses;
    for (std::uint32_t lane = 0; lane < kLaneCount; ++lane) {
      ids.set(lane, kLaneCount * set + lane);
      masses.set(lane, static_cast<float>(lane));
      if ((set >> lane & 1) != 0) expected.push_back({{}, ids[lane], masses[lane]});
    }
    columns.reserve(columns.size() + kLaneCount);
    const NewRows<Particle> added = columns.push(set);
    added.put(&Particle::id, ids.all());
    added.put(&Particle::mass, masses.all());
  }
  ASSERT_EQ(columns.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) ASSERT_EQ(columns[i], expected[i]);  // position unwritten
}

}  // namespace
}  // namespace tessera::core
