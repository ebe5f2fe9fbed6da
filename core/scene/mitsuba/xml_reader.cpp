// SPDX-License-Identifier: Apache-2.0
#include "core/scene/mitsuba/xml_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <pugixml.hpp>
#include <sstream>
#include <utility>

#include "core/base/letter_case.hpp"
#include "core/base/printable.hpp"
#include "core/base/suggestion.hpp"
#include "core/image/srgb.hpp"
#include "core/scene/import/selection.hpp"
#include "core/scene/mitsuba/graph_passes.hpp"
#include "core/scene/mitsuba/line_index.hpp"
#include "core/scene/mitsuba/parameters.hpp"
#include "core/scene/mitsuba/parse_values.hpp"
#include "core/scene/mitsuba/read_transform.hpp"
#include "core/scene/mitsuba/spectra.hpp"

namespace tessera::core::mitsuba {
namespace {

constexpr int kMaxIncludeDepth = 15;
constexpr std::size_t kMaxFiles = 1000, kMaxNodes = std::size_t{1} << 24;
constexpr std::size_t kMaxFolders = 100;

// <srgb> is one of Mitsuba 0.x, as are colours like "#ff8000".
std::optional<Rgb> read_color(std::string_view tag, std::string_view text) {
  auto color = parse_hexadecimal(text);
  if (!color) color = parse_triple(text);
  if (!color) return std::nullopt;
  const auto linear = [tag](float c) { return tag == "srgb" ? srgb_decode(static_cast<double>(c)) : c; };
  return Rgb{linear(color->x), linear(color->y), linear(color->z)};
}

constexpr std::pair<std::string_view, Kind> kObjectTags[] = {
    {"scene", Kind::kScene},     {"shape", Kind::kShape},     {"bsdf", Kind::kBsdf},
    {"texture", Kind::kTexture}, {"emitter", Kind::kEmitter}, {"sensor", Kind::kSensor},
    {"film", Kind::kFilm},       {"sampler", Kind::kSampler}, {"rfilter", Kind::kFilter},
    {"medium", Kind::kMedium},   {"phase", Kind::kPhase},     {"integrator", Kind::kIntegrator},
    {"volume", Kind::kVolume},
};

std::optional<Kind> kind_of_tag(std::string_view tag) {
  for (const auto& [name, kind] : kObjectTags)
    if (tag == name) return kind;
  return std::nullopt;
}

class GraphReader {
 public:
  explicit GraphReader(SceneBuilder& builder) : builder_(builder) {}
  Result<SceneGraph> read();

 private:
  // The file that is being read.
  struct Source {
    std::uint32_t file = 0;
    bool is_old = false;  // before version 2: names in camelCase
    LineIndex lines;
    int depth = 0;  // of includes
  };
  struct Reference {
    NodeId owner;
    std::size_t property;
    std::string id;
  };

  Status read_file(const std::string& path, NodeId parent, std::string name, int depth);
  Status read_root(const Source& source, pugi::xml_node root, NodeId parent, std::string name);
  Status read_children(const Source& source, pugi::xml_node xml, NodeId owner, int nesting);
  Status read_element(const Source& source, pugi::xml_node xml, NodeId owner, int nesting);
  Result<NodeId> read_object(const Source& source, pugi::xml_node xml, const Attributes& attributes,
                             Kind kind, NodeId owner, int nesting);
  Status include(const Source& source, const Attributes& attributes, NodeId owner, Location where);
  // A value; nullopt after a warning.
  Result<std::optional<Property::Value>> read_value(const Source& source, pugi::xml_node xml,
                                                    const Attributes& attributes, NodeId owner,
                                                    Location where);
  Result<Transform> read_transform(const Source& source, pugi::xml_node xml);
  Result<KeyedTransforms> read_animation(const Source& source, pugi::xml_node xml);
  // The colour or the factor of light that a spectrum is for its owner.
  std::optional<Property::Value> read_spectrum(const Attributes& attributes, NodeId owner, Location where);
  // Returns whether the tag is one of these: default, path, ref, alias.
  bool read_statement(std::string_view tag, const Source& source, const Attributes& attributes, NodeId owner,
                      Location where);
  void add_path(const std::string& folder, Location where);
  Result<Attributes> attributes_of(const Source& source, pugi::xml_node xml) const;
  void add_property(const Source& source, NodeId owner, std::string_view name, Location where,
                    Property::Value value);

  Status resolve_references();
  Status check_replaced_parameters() const;

  Location location(const Source& source, pugi::xml_node xml) const {
    return {source.file, source.lines.line_at(xml.offset_debug())};
  }
  tl::unexpected<Error> error_at(Location where, std::string_view what) const {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{}:{}: {}", builder_.shown(graph_.files[where.file]), where.line, what));
  }
  void warn(Location where, std::string_view kind, std::string text) {
    builder_.warn(graph_.files[where.file], where.line, kind, text);
  }

  SceneBuilder& builder_;
  SceneGraph graph_;
  Parameters parameters_;
  std::map<std::string, NodeId, std::less<>> ids_;
  std::vector<Reference> references_;
};

Result<SceneGraph> GraphReader::read() {
  graph_.nodes.push_back(
      {.kind = Kind::kScene, .type = "scene", .id = {}, .where = {0, 1}, .properties = {}});
  if (const Status done = read_file(builder_.scene_path(), 0, {}, 0); !done) return fail(done.error());
  if (const Status used = check_replaced_parameters(); !used) return fail(used.error());
  graph_.camera = parameters_.value_of(std::string(kMitsubaSelection) + std::string(kSelectCamera));
  if (const Status done = resolve_references(); !done) return fail(done.error());
  if (const auto deep = too_deep(graph_))
    return error_at(deep->where,
                    fmt::format("references form a circle, or are more than {} deep", kMaxNesting));
  return std::move(graph_);
}

Status GraphReader::read_file(const std::string& path, NodeId parent, std::string name, int depth) {
  auto text = builder_.read(path);
  if (!text) return fail(text.error());
  if (graph_.files.size() >= kMaxFiles)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: more than {} files are included", builder_.shown(path), kMaxFiles));
  Source source{static_cast<std::uint32_t>(graph_.files.size()), false, LineIndex(*text), depth};
  graph_.files.push_back(path);
  graph_.folders.push_back(path);
  pugi::xml_document document;
  // What XML predefines is all that this parser expands.
  const auto parsed = document.load_buffer(text->data(), text->size());
  if (!parsed) {
    const Location where{source.file, source.lines.line_at(parsed.offset)};
    return error_at(where, fmt::format("is no well-formed XML: {}", parsed.description()));
  }
  return read_root(source, document.document_element(), parent, std::move(name));
}

Status GraphReader::read_root(const Source& source_file, pugi::xml_node root, NodeId parent,
                              std::string name) {
  Source source = source_file;
  const Location where = location(source, root);
  const std::string_view tag = root.name();
  const auto kind = kind_of_tag(tag);
  if (!kind || (source.depth == 0 && *kind != Kind::kScene))
    return error_at(where, fmt::format("is no Mitsuba scene: the root is <{}>, not <scene>", printable(tag)));
  source.is_old = std::string_view(root.attribute("version").value()).starts_with("0.");
  if (*kind == Kind::kScene) return read_children(source, root, parent, 1);
  const auto attributes = attributes_of(source, root);
  if (!attributes) return fail(attributes.error());
  const auto node = read_object(source, root, *attributes, *kind, parent, 1);
  if (!node) return fail(node.error());
  add_property(source, parent, name, where, Child{*node});
  return {};
}

Status GraphReader::read_children(const Source& source, pugi::xml_node xml, NodeId owner, int nesting) {
  for (const pugi::xml_node child : xml.children()) {
    if (child.type() != pugi::node_element) continue;
    if (const Status done = read_element(source, child, owner, nesting); !done) return done;
  }
  return {};
}

Status GraphReader::read_element(const Source& source, pugi::xml_node xml, NodeId owner, int nesting) {
  const Location where = location(source, xml);
  if (nesting > kMaxNesting)
    return error_at(where, fmt::format("elements are nested more than {} deep", kMaxNesting));
  const auto attributes = attributes_of(source, xml);
  if (!attributes) return fail(attributes.error());
  const std::string_view tag = xml.name();
  if (read_statement(tag, source, *attributes, owner, where)) return {};
  if (tag == "include") return include(source, *attributes, owner, where);
  const bool is_plugin = tag == "spectrum" && attributes->find("type") != nullptr;
  if (const auto kind = is_plugin ? std::optional(Kind::kTexture) : kind_of_tag(tag)) {
    const auto node = read_object(source, xml, *attributes, *kind, owner, nesting);
    if (!node) return fail(node.error());
    add_property(source, owner, attributes->text("name"), where, Child{*node});
    return {};
  }
  auto value = read_value(source, xml, *attributes, owner, where);
  if (!value) return fail(value.error());
  if (*value) add_property(source, owner, attributes->text("name"), where, std::move(**value));
  return {};
}

Result<NodeId> GraphReader::read_object(const Source& source, pugi::xml_node xml,
                                        const Attributes& attributes, Kind kind, NodeId owner, int nesting) {
  const Location where = location(source, xml);
  if (graph_.nodes.size() >= kMaxNodes)
    return error_at(where, fmt::format("the scene has more than {} objects", kMaxNodes));
  const auto id = static_cast<NodeId>(graph_.nodes.size());
  std::string type = in_lower_case(attributes.text("type"));
  if (type != attributes.text("type"))
    warn(where, "capital letters " + type,
         fmt::format("there is no type {}; {} is used", in_quotes(attributes.text("type")), in_quotes(type)));
  graph_.nodes.push_back({.kind = kind,
                          .type = std::move(type),
                          .id = std::string(attributes.text("id")),
                          .where = where,
                          .properties = {},
                          .in_emitter = kind == Kind::kEmitter || graph_.nodes[owner].in_emitter});
  if (const std::string name = graph_.nodes.back().id; !name.empty() && !ids_.try_emplace(name, id).second)
    warn(where, "duplicate id " + name,
         fmt::format("the id {} is there already; references mean the first one", in_quotes(name)));
  if (const Status done = read_children(source, xml, id, nesting + 1); !done) return fail(done.error());
  if (source.is_old) upgrade_node(graph_.nodes[id]);
  return id;
}

Status GraphReader::include(const Source& source, const Attributes& attributes, NodeId owner,
                            Location where) {
  const std::string written(attributes.text("filename"));
  if (source.depth >= kMaxIncludeDepth)
    return error_at(where, fmt::format("files are included more than {} deep", kMaxIncludeDepth));
  const auto path = builder_.find(written, graph_.folders);
  if (!path) return error_at(where, fmt::format("the included file {} does not exist", in_quotes(written)));
  return read_file(*path, owner, std::string(attributes.text("name")), source.depth + 1);
}

bool GraphReader::read_statement(std::string_view tag, const Source& source, const Attributes& attributes,
                                 NodeId owner, Location where) {
  if (tag == "default") {
    parameters_.define(attributes.text("name"), std::string(attributes.text("value")));
  } else if (tag == "path") {
    add_path(std::string(attributes.text("value")), where);
  } else if (tag == "ref") {
    add_property(source, owner, attributes.text("name"), where, Child{});
    references_.push_back(
        {owner, graph_.nodes[owner].properties.size() - 1, std::string(attributes.text("id"))});
  } else if (tag == "alias") {
    const auto known = ids_.find(attributes.text("id"));
    if (known == ids_.end())
      warn(where, "alias of nothing " + std::string(attributes.text("id")),
           fmt::format("there is no object {}; the alias is left out", in_quotes(attributes.text("id"))));
    else
      ids_.try_emplace(std::string(attributes.text("as")), known->second);
  } else {
    return false;
  }
  return true;
}

// The folder is searched before all others. It is relative to the file that names it.
void GraphReader::add_path(const std::string& folder, Location where) {
  if (folder.empty()) return;
  if (graph_.folders.size() >= kMaxFolders + kMaxFiles) {
    warn(where, "many paths", fmt::format("more than {} folders are not searched", kMaxFolders));
    return;
  }
  const std::string inside = (folder.back() == '/' ? folder : folder + "/") + ".";
  graph_.folders.insert(graph_.folders.begin(), path_beside(graph_.files[where.file], inside));
}

Result<std::optional<Property::Value>> GraphReader::read_value(const Source& source, pugi::xml_node xml,
                                                               const Attributes& attributes, NodeId owner,
                                                               Location where) {
  const std::string_view tag = xml.name(), text = attributes.text("value");
  std::optional<Property::Value> value;
  if (tag == "transform") {
    const auto transform = read_transform(source, xml);
    if (!transform) return fail(transform.error());
    value = *transform;
  } else if (tag == "animation") {
    auto keys = read_animation(source, xml);
    if (!keys) return fail(keys.error());
    if (!keys->empty()) value = *std::move(keys);
  } else if (tag == "float") {
    value = parse_number(text);
  } else if (tag == "integer") {
    value = parse_integer(text);
  } else if (tag == "boolean") {
    value = parse_boolean(text);
  } else if (tag == "string") {
    value = std::string(text);
  } else if (tag == "rgb" || tag == "srgb") {
    value = read_color(tag, text);
  } else if (tag == "point" || tag == "vector") {
    if (const auto vector = read_step("translate", attributes)) value = vector->origin;
  } else if (tag == "spectrum") {
    value = read_spectrum(attributes, owner, where);
  } else {
    warn(where, fmt::format("element {}", tag),
         fmt::format("the element <{}> is not known; it is left out", printable(tag)));
    return std::nullopt;
  }
  if (!value)
    warn(where, fmt::format("value {}", tag),
         fmt::format("{} is no value of <{}>; the parameter {} is left out", in_quotes(text), printable(tag),
                     in_quotes(attributes.text("name"))));
  return value;
}

std::optional<Property::Value> GraphReader::read_spectrum(const Attributes& attributes, NodeId owner,
                                                          Location where) {
  const bool of_light = graph_.nodes[owner].in_emitter;
  const auto color_of = [&](const std::optional<Samples>& samples) -> std::optional<Property::Value> {
    if (!samples) return std::nullopt;
    return sampled_color(*samples, of_light);
  };
  const std::string file(attributes.text("filename"));
  if (file.empty()) {
    const std::string_view text = attributes.text("value");
    const auto constant = parse_number(text);
    if (!constant) return color_of(parse_samples(text));
    return of_light ? Property::Value(uniform_light(*constant)) : Property::Value(*constant);
  }
  const auto path = builder_.find(file, graph_.folders);
  const auto text =
      path ? builder_.read(*path) : fail(ErrorCode::kNotFound, in_quotes(file) + " does not exist");
  if (text) return color_of(parse_sample_file(*text));
  warn(where, "spectrum file " + file, text.error().message);
  return std::nullopt;
}

// Keyframes in the order of their times.
Result<KeyedTransforms> GraphReader::read_animation(const Source& source, pugi::xml_node xml) {
  KeyedTransforms keys;
  for (const pugi::xml_node child : xml.children("transform")) {
    const auto attributes = attributes_of(source, child);
    if (!attributes) return fail(attributes.error());
    const auto transform = read_transform(source, child);
    if (!transform) return fail(transform.error());
    const auto time = parse_number(attributes->text("time"));
    const bool fits =
        time && std::fabs(*time) <= 1e6 && (keys.empty() || static_cast<float>(*time) > keys.back().frame);
    if (fits)
      keys.push_back({static_cast<float>(*time), *transform});
    else
      warn(location(source, child), "time of a keyframe",
           "a keyframe needs a 'time' after that of the one before; it is left out");
  }
  return keys;
}

Result<Transform> GraphReader::read_transform(const Source& source, pugi::xml_node xml) {
  Transform transform;
  for (const pugi::xml_node child : xml.children()) {
    if (child.type() != pugi::node_element) continue;
    const auto attributes = attributes_of(source, child);
    if (!attributes) return fail(attributes.error());
    if (const auto step = read_step(child.name(), *attributes))
      transform = compose(*step, transform);
    else
      warn(location(source, child), fmt::format("step {}", child.name()),
           fmt::format(
               "the step <{}> of the transform is unknown, lacks a value or is singular; it is left out",
               printable(child.name())));
  }
  return transform;
}

Result<Attributes> GraphReader::attributes_of(const Source& source, pugi::xml_node xml) const {
  Attributes attributes;
  for (const pugi::xml_attribute attribute : xml.attributes()) {
    auto value = parameters_.substitute(attribute.value());
    if (value) {
      attributes.add(attribute.name(), std::move(*value));
      continue;
    }
    const Location where = location(source, xml);
    if (value.error().empty()) return error_at(where, "a value is too long with its parameters");
    if (value.error() == "$")
      return error_at(where,
                      fmt::format("{} has a '$' without the name of a parameter; write '$name', without "
                                  "braces, or '\\$' for the sign itself",
                                  in_quotes(attribute.value())));
    return error_at(where,
                    fmt::format("the parameter {} is not defined; give it a <default>, or a value with "
                                "-D {}=VALUE",
                                printable(value.error()), printable(value.error().substr(1))));
  }
  return attributes;
}

void GraphReader::add_property(const Source& source, NodeId owner, std::string_view name, Location where,
                               Property::Value value) {
  std::string known_name = source.is_old ? in_snake_case(name) : std::string(name);
  graph_.nodes[owner].properties.push_back({std::move(known_name), where, std::move(value), false});
}

// The names stand in a parameter, one a line.
Status GraphReader::check_replaced_parameters() const {
  std::istringstream names(
      parameters_.value_of(std::string(kMitsubaSelection) + std::string(kReplacedParameters)));
  const auto& used = parameters_.used();
  for (std::string name; std::getline(names, name);)
    if (!used.contains(name))
      return fail(unused_parameter(name, {used.begin(), used.end()}).within(builder_.shown(graph_.files[0])));
  return {};
}

Status GraphReader::resolve_references() {
  for (const Reference& reference : references_) {
    Property& property = graph_.nodes[reference.owner].properties[reference.property];
    const auto known = ids_.find(reference.id);
    if (known != ids_.end()) {
      property.value = Child{known->second};
      continue;
    }
    warn(
        property.where, "reference to nothing " + reference.id,
        fmt::format("there is no object with the id {}; the reference is left out", in_quotes(reference.id)));
    property.value = false;
    property.used = true;
  }
  return {};
}

}  // namespace

std::string_view tag_of(Kind kind) {
  for (const auto& [name, known] : kObjectTags)
    if (known == kind) return name;
  return "object";
}

Result<SceneGraph> read_scene_graph(SceneBuilder& builder) {
  return GraphReader(builder).read();
}

}  // namespace tessera::core::mitsuba
