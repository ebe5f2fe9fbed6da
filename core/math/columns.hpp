// SPDX-License-Identifier: Apache-2.0
// Structures of arrays: a column for each number of a struct `Row`, which is the one list of the fields.
// Fields are floats, 32-bit words, and structs of these. Rows are read and written one by one, or in lanes:
// a field of several rows at once. A field that nobody writes or reads costs its memory only.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/math/lane_array.hpp"

namespace tessera::core {

template <typename Row>
inline constexpr std::size_t kColumnsOf = sizeof(Row) / sizeof(float);

// What holds a field of kLaneCount rows.
template <typename Field>
struct FieldInLanes;
template <>
struct FieldInLanes<float> {
  using Type = FloatN;
};
template <>
struct FieldInLanes<std::uint32_t> {
  using Type = U32xN;
};
template <template <typename> typename Fields>
struct FieldInLanes<Fields<float>> {
  using Type = Fields<FloatN>;
};
template <typename Field>
using InLanes = typename FieldInLanes<Field>::Type;

// The number of the first column of a field.
template <typename Row, typename Field>
std::size_t column_of(Field Row::*field) {
  static_assert(std::is_trivially_copyable_v<Row> && alignof(Row) == sizeof(float));
  static const Row some{};
  return static_cast<std::size_t>(reinterpret_cast<const float*>(&(some.*field)) -
                                  reinterpret_cast<const float*>(&some));
}

// Rows in columns that something else owns. The Row of a view is const if the view is for reading.
template <typename Row>
class ColumnsView {
 public:
  using Value = std::remove_const_t<Row>;
  using Number = std::conditional_t<std::is_const_v<Row>, const float, float>;  // or a word of as many bits
  static constexpr std::size_t kColumns = kColumnsOf<Value>;

  ColumnsView() = default;
  // Column c begins at first + c * stride.
  ColumnsView(Number* first, std::size_t stride, std::size_t count)
      : first_(first), stride_(stride), count_(count) {}
  operator ColumnsView<const Value>() const { return {first_, stride_, count_}; }

  std::size_t size() const { return count_; }
  bool empty() const { return count_ == 0; }
  Number* column(std::size_t c) const { return first_ + c * stride_; }
  ColumnsView rows(std::size_t begin, std::size_t count) const {
    assert(begin + count <= count_);
    return {first_ + begin, stride_, count};
  }
  // A field of all rows.
  template <typename Owner, typename Field>
  auto field(Field Owner::*field) const {
    static_assert(std::is_same_v<Owner, Value>);
    using Part = std::conditional_t<std::is_const_v<Row>, const Field, Field>;
    return ColumnsView<Part>(column(column_of(field)), stride_, count_);
  }

  Value operator[](std::size_t i) const { return copied(i, std::make_index_sequence<kColumns>()); }
  void set(std::size_t i, const Value& row) const { copy(row, i, std::make_index_sequence<kColumns>()); }
  template <typename Owner, typename Field>
  Field get(Field Owner::*of, std::size_t i) const {
    return field(of)[i];
  }

  // The rows of this number in each lane.
  auto in_lanes(U32xN rows) const { return gathered(rows, std::make_index_sequence<kColumns>()); }

 private:
  template <std::size_t... kColumn>
  Value copied(std::size_t i, std::index_sequence<kColumn...>) const {
    return std::bit_cast<Value>(std::array<float, kColumns>{first_[i + kColumn * stride_]...});
  }
  template <std::size_t... kColumn>
  void copy(const Value& row, std::size_t i, std::index_sequence<kColumn...>) const {
    const auto numbers = std::bit_cast<std::array<float, kColumns>>(row);
    ((first_[i + kColumn * stride_] = numbers[kColumn]), ...);
  }
  template <std::size_t... kColumn>
  auto gathered(U32xN rows, std::index_sequence<kColumn...>) const {
    return std::bit_cast<InLanes<Value>>(
        std::array<FloatN, kColumns>{FloatN::gather(column(kColumn), rows.v)...});
  }

  Number* first_ = nullptr;
  std::size_t stride_ = 0, count_ = 0;
};

// One row of columns, of which single fields are read.
template <typename Row>
class RowView {
 public:
  RowView(ColumnsView<const Row> columns, std::size_t i) : columns_(columns), i_(i) {}

  template <typename Field>
  Field get(Field Row::*field) const {
    return columns_.get(field, i_);
  }

 private:
  ColumnsView<const Row> columns_;
  std::size_t i_;
};

// A row on its own, for functions of columns.
template <typename Row>
class SingleRow {
 public:
  explicit SingleRow(const Row& row) : numbers_(std::bit_cast<Numbers>(row)) {}
  ColumnsView<Row> all() { return {numbers_.data(), 1, 1}; }
  Row row() const { return std::bit_cast<Row>(numbers_); }

 private:
  using Numbers = std::array<float, kColumnsOf<Row>>;
  Numbers numbers_;
};

// A row in each lane, of columns that must outlive this.
template <typename Row>
class RowLanes {
 public:
  RowLanes(ColumnsView<const Row> columns, const WordLanes& rows) : columns_(columns), rows_(rows) {}

  std::uint32_t row(std::size_t lane) const { return rows_[lane]; }
  Row operator[](std::size_t lane) const { return columns_[rows_[lane]]; }
  template <typename Field>
  Field get(Field Row::*field, std::size_t lane) const {
    return columns_.get(field, rows_[lane]);
  }
  RowView<Row> at(std::size_t lane) const { return {columns_, rows_[lane]}; }
  template <typename Field>
  InLanes<Field> all(Field Row::*field) const {
    return columns_.field(field).in_lanes(rows_.all());
  }
  // With the row of lane `from` in each lane outside of a set.
  RowLanes filled(unsigned set, std::size_t from) const {
    RowLanes filled = *this;
    for (std::size_t lane = 0; lane < kLaneCount; ++lane)
      if ((set >> lane & 1) == 0) filled.rows_.set(lane, rows_[from]);
    return filled;
  }

 private:
  ColumnsView<const Row> columns_;
  WordLanes rows_;
};

// The lanes of a set, moved to the front in their order.
class LaneCompression {
 public:
  explicit LaneCompression(unsigned set) : order_(U32xN::load_bytes(kOrders[set].data())) {}
  FloatN operator()(FloatN lanes) const { return permuted(lanes, order_); }

 private:
  using Order = std::array<std::uint8_t, kLaneCount>;
  static constexpr auto kOrders = [] {
    std::array<Order, 1 << kLaneCount> orders{};
    for (std::size_t set = 0; set < orders.size(); ++set) {
      std::size_t count = 0;
      for (std::uint8_t lane = 0; lane < kLaneCount; ++lane)
        if ((set >> lane & 1) != 0) orders[set][count++] = lane;
    }
    return orders;
  }();

  U32xN order_;
};

// New rows, whose fields are written a field at a time, from the lanes of a set.
template <typename Row>
class NewRows {
 public:
  // There must be room for kLaneCount rows.
  NewRows(ColumnsView<Row> rows, LaneCompression compression) : rows_(rows), compression_(compression) {}

  template <typename Field>
  void put(Field Row::*field, const InLanes<Field>& lanes) const {
    static constexpr std::size_t kColumns = kColumnsOf<Field>;
    put_columns(column_of(field), std::bit_cast<std::array<FloatN, kColumns>>(lanes),
                std::make_index_sequence<kColumns>());
  }
  template <typename Field>
  NewRows<Field> field(Field Row::*field) const {
    return {rows_.field(field), compression_};
  }
  // Writes the same row into all.
  void fill(const Row& row) const {
    for (std::size_t c = 0; c < kColumnsOf<Row>; ++c)
      FloatN::broadcast(reinterpret_cast<const float*>(&row)[c]).store_unaligned(rows_.column(c));
  }

 private:
  template <std::size_t... kColumn>
  void put_columns(std::size_t first, const std::array<FloatN, sizeof...(kColumn)>& lanes,
                   std::index_sequence<kColumn...>) const {
    (compression_(lanes[kColumn]).store_unaligned(rows_.column(first + kColumn)), ...);
  }

  ColumnsView<Row> rows_;
  LaneCompression compression_;
};

// A list of rows. Initially all numbers are 0, which stays so for fields that nobody writes.
template <typename Row>
class Columns {
 public:
  Columns() = default;
  explicit Columns(std::size_t count) { resize(count); }
  explicit Columns(std::span<const Row> rows) : Columns(rows.size()) {
    for (std::size_t i = 0; i < rows.size(); ++i) set(i, rows[i]);
  }
  explicit Columns(ColumnsView<const Row> rows) : Columns(rows.size()) {
    for (std::size_t c = 0; c < kColumnsOf<Row>; ++c)
      std::copy_n(rows.column(c), rows.size(), all().column(c));
  }

  std::size_t size() const { return count_; }
  bool empty() const { return count_ == 0; }
  ColumnsView<Row> all() { return {numbers_.data(), stride_, count_}; }
  ColumnsView<const Row> all() const { return {numbers_.data(), stride_, count_}; }
  Row operator[](std::size_t i) const { return all()[i]; }
  void set(std::size_t i, const Row& row) { all().set(i, row); }

  void reserve(std::size_t count) {
    if (count + kLaneCount > stride_) move_to(count);
  }
  void resize(std::size_t count) {
    reserve(count);
    count_ = count;
  }
  void clear() { count_ = 0; }
  void push(const Row& row) {
    if (count_ + kLaneCount >= stride_) move_to(count_ + 1);
    ++count_;
    set(count_ - 1, row);
  }
  // Adds a row for each lane of a set; there must be room.
  NewRows<Row> push(unsigned set) {
    assert(count_ + kLaneCount <= stride_);
    const ColumnsView<Row> added(numbers_.data() + count_, stride_, kLaneCount);
    count_ += static_cast<std::size_t>(std::popcount(set));
    return {added, LaneCompression(set)};
  }

 private:
  // Columns take an odd number of cache lines, so that the same rows of many columns do not compete for one
  // set of a cache.
  void move_to(std::size_t count) {
    constexpr std::size_t kLine = 16;
    const std::size_t room = std::max(count, 2 * count_) + kLaneCount;
    const std::size_t stride = ((room + kLine - 1) / kLine | 1) * kLine;
    std::vector<float> moved(stride * kColumnsOf<Row>);
    for (std::size_t c = 0; c < kColumnsOf<Row>; ++c)
      std::copy_n(numbers_.data() + c * stride_, count_, moved.data() + c * stride);
    numbers_ = std::move(moved);
    stride_ = stride;
  }

  std::vector<float> numbers_;
  std::size_t stride_ = 0, count_ = 0;
};

}  // namespace tessera::core
