// SPDX-License-Identifier: Apache-2.0
#include "core/scene/import/nested_instances.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/scene/import/empty_objects.hpp"

namespace tessera::core {
namespace {

// What an object holds besides shapes of its own.
struct Nesting {
  std::vector<InstanceDescription> instances;
  bool has_shapes = false;
};

bool is_instance(const ShapeDescription& shape) {
  return std::holds_alternative<InstanceDescription>(shape);
}

bool is_nested(const SceneDescription& scene) {
  return std::ranges::any_of(scene.objects, [](const ObjectDescription& object) {
    return std::ranges::any_of(object.shapes, is_instance);
  });
}

// Moves the instances out of the object.
Nesting take_instances(ObjectDescription& object) {
  Nesting nesting;
  std::vector<ShapeDescription> shapes;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < object.shapes.size(); ++i) {
    if (const auto* instance = std::get_if<InstanceDescription>(&object.shapes[i])) {
      nesting.instances.push_back(*instance);
      continue;
    }
    shapes.push_back(std::move(object.shapes[i]));
    if (i < object.shape_names.size()) names.push_back(std::move(object.shape_names[i]));
  }
  object.shapes = std::move(shapes);
  object.shape_names = std::move(names);
  nesting.has_shapes = !object.shapes.empty();
  return nesting;
}

class Flattener {
 public:
  Flattener(SceneDescription& scene, std::uint64_t limit) : scene_(scene), limit_(limit) {}

  Status flatten();

 private:
  Status check_references() const;
  // Objects before those that hold them (Kahn 1962); an error if some hold themselves.
  Result<std::vector<std::uint32_t>> innermost_first() const;
  // The number of instances that replace one of each object; saturates.
  std::vector<std::uint64_t> counts(const std::vector<std::uint32_t>& innermost_first) const;
  Status check_limit(const std::vector<std::uint64_t>& counts) const;
  void expand_shapes();
  // Appends what replaces an instance.
  void expand(const InstanceDescription& outermost, const std::string& name,
              const std::vector<MotionStep>* motion);

  SceneDescription& scene_;
  const std::uint64_t limit_;
  std::vector<Nesting> objects_;
  // Of the flat scene.
  std::vector<ShapeDescription> shapes_;
  std::vector<std::string> names_;
  std::vector<InstanceMotion> motions_;
};

Status Flattener::flatten() {
  for (ObjectDescription& object : scene_.objects) objects_.push_back(take_instances(object));
  if (Status ok = check_references(); !ok) return ok;
  const auto order = innermost_first();
  if (!order) return fail(order.error());
  if (Status ok = check_limit(counts(*order)); !ok) return ok;
  expand_shapes();
  remove_empty_objects(scene_);
  return {};
}

Status Flattener::check_references() const {
  const auto exists = [&](const InstanceDescription& instance) { return instance.object < objects_.size(); };
  const auto all_exist = [&](const Nesting& object) { return std::ranges::all_of(object.instances, exists); };
  const auto shape_exists = [&](const ShapeDescription& shape) {
    const auto* instance = std::get_if<InstanceDescription>(&shape);
    return instance == nullptr || exists(*instance);
  };
  if (std::ranges::all_of(objects_, all_exist) && std::ranges::all_of(scene_.shapes, shape_exists)) return {};
  return fail(ErrorCode::kInvalidArgument, "an instance refers to an object that does not exist");
}

Result<std::vector<std::uint32_t>> Flattener::innermost_first() const {
  std::vector<std::uint32_t> waiting_for, order;
  std::vector<std::vector<std::uint32_t>> holders(objects_.size());
  for (std::uint32_t i = 0; i < objects_.size(); ++i) {
    waiting_for.push_back(static_cast<std::uint32_t>(objects_[i].instances.size()));
    for (const InstanceDescription& instance : objects_[i].instances) holders[instance.object].push_back(i);
    if (objects_[i].instances.empty()) order.push_back(i);
  }
  for (std::size_t next = 0; next < order.size(); ++next)
    for (const std::uint32_t holder : holders[order[next]])
      if (--waiting_for[holder] == 0) order.push_back(holder);
  if (order.size() == objects_.size()) return order;
  const auto in_cycle = std::ranges::find_if(waiting_for, [](std::uint32_t count) { return count > 0; });
  const auto index = static_cast<std::size_t>(in_cycle - waiting_for.begin());
  return fail(ErrorCode::kInvalidArgument,
              fmt::format("object '{}' holds an instance of itself, directly or through others",
                          scene_.objects[index].name));
}

std::vector<std::uint64_t> Flattener::counts(const std::vector<std::uint32_t>& innermost_first) const {
  std::vector<std::uint64_t> counts(objects_.size());
  for (const std::uint32_t i : innermost_first) {
    counts[i] = objects_[i].has_shapes ? 1 : 0;
    for (const InstanceDescription& instance : objects_[i].instances)
      counts[i] = std::min(counts[i] + counts[instance.object], limit_ + 1);
  }
  return counts;
}

Status Flattener::check_limit(const std::vector<std::uint64_t>& counts) const {
  std::uint64_t total = 0;
  for (const ShapeDescription& shape : scene_.shapes)
    if (const auto* instance = std::get_if<InstanceDescription>(&shape))
      total = std::min(total + counts[instance->object], limit_ + 1);
  if (total <= limit_) return {};
  return fail(ErrorCode::kResourceExhausted,
              fmt::format("objects hold instances of others, which makes more than {} in all", limit_));
}

void Flattener::expand_shapes() {
  std::vector<const std::vector<MotionStep>*> motions(scene_.shapes.size());
  for (const InstanceMotion& motion : scene_.animation.instances)
    if (motion.shape < motions.size()) motions[motion.shape] = &motion.steps;
  for (std::size_t i = 0; i < scene_.shapes.size(); ++i) {
    std::string name = i < scene_.shape_names.size() ? std::move(scene_.shape_names[i]) : std::string();
    if (const auto* instance = std::get_if<InstanceDescription>(&scene_.shapes[i])) {
      expand(*instance, name, motions[i]);
    } else {
      shapes_.push_back(std::move(scene_.shapes[i]));
      names_.push_back(std::move(name));
    }
  }
  scene_.shapes = std::move(shapes_);
  scene_.shape_names = std::move(names_);
  scene_.animation.instances = std::move(motions_);
}

void Flattener::expand(const InstanceDescription& outermost, const std::string& name,
                       const std::vector<MotionStep>* motion) {
  // An instance on the way down, and its transform within the outermost one.
  struct Step {
    InstanceDescription instance;
    Transform within;
  };
  std::vector<Step> waiting{{outermost, {}}};
  while (!waiting.empty()) {
    const Step step = waiting.back();
    waiting.pop_back();
    const Nesting& object = objects_[step.instance.object];
    if (object.has_shapes) {
      if (motion != nullptr) {
        std::vector<MotionStep> steps{step.within};
        steps.insert(steps.end(), motion->begin(), motion->end());
        motions_.push_back({static_cast<std::uint32_t>(shapes_.size()), std::move(steps)});
      }
      shapes_.emplace_back(step.instance);
      names_.push_back(name);
    }
    for (auto inner = object.instances.rbegin(); inner != object.instances.rend(); ++inner)
      waiting.push_back({{inner->object, compose(step.instance.to_world, inner->to_world),
                          step.instance.material ? step.instance.material : inner->material},
                         compose(step.within, inner->to_world)});
  }
}

}  // namespace

Status flatten_instances(SceneDescription& scene, std::uint64_t limit) {
  if (!is_nested(scene)) return {};
  return Flattener(scene, limit).flatten();
}

}  // namespace tessera::core
