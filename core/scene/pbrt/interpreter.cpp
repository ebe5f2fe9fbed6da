// SPDX-License-Identifier: Apache-2.0
#include "core/scene/pbrt/interpreter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "core/base/letter_case.hpp"
#include "core/scene/import/emission_only.hpp"
#include "core/scene/loader/gunzip.hpp"
#include "core/scene/loader/wording.hpp"
#include "core/scene/pbrt/files.hpp"
#include "core/spectra/color_space.hpp"

namespace tessera::core::pbrt {
namespace {

constexpr std::size_t kMaxIncludeDepth = 32;
constexpr std::uint64_t kMaxFiles = 10'000;
constexpr std::size_t kMaxSavedStates = 10'000, kMaxDefaults = 1000;  // values

// A list of defaults with those of `more`, which come later.
std::shared_ptr<const Parameters> joined(const std::shared_ptr<const Parameters>& earlier,
                                         const Parameters& more) {
  Parameters all = earlier ? *earlier : Parameters(more.place());
  for (const Parameter& parameter : more.list()) all.add(parameter);
  return std::make_shared<const Parameters>(std::move(all));
}

// Of all parameters in the list, with one for each parameter itself.
std::size_t count_values(const Parameters& parameters) {
  std::size_t count = 0;
  for (const Parameter& parameter : parameters.list()) count += 1 + parameter.size();
  return count;
}

// The name of an option, which counts without capitals, dashes and underscores.
std::string without_separators(std::string_view name) {
  std::string plain;
  for (const char c : name)
    if (c != '-' && c != '_') plain += in_lower_case(c);
  return plain;
}

}  // namespace

Interpreter::Handler Interpreter::handler_of(std::string_view directive) {
  using I = Interpreter;
  static constexpr std::pair<std::string_view, Handler> kDirectives[] = {
      {"Accelerator", &I::accelerator},
      {"ActiveTransform", &I::active_transform},
      {"AreaLightSource", &I::area_light_source},
      {"Attribute", &I::attribute},
      {"AttributeBegin", &I::attribute_begin},
      {"AttributeEnd", &I::attribute_end},
      {"Camera", &I::camera},
      {"ColorSpace", &I::color_space},
      {"ConcatTransform", &I::concat_transform},
      {"CoordSysTransform", &I::coord_sys_transform},
      {"CoordinateSystem", &I::coordinate_system},
      {"Film", &I::film},
      {"Identity", &I::identity},
      {"Import", &I::import_file},
      {"Include", &I::include_file},
      {"Integrator", &I::integrator},
      {"LightSource", &I::light_source},
      {"LookAt", &I::look_at_directive},
      {"MakeNamedMaterial", &I::make_named_material},
      {"MakeNamedMedium", &I::make_named_medium},
      {"Material", &I::material},
      {"MediumInterface", &I::medium_interface},
      {"NamedMaterial", &I::named_material},
      {"ObjectBegin", &I::object_begin},
      {"ObjectEnd", &I::object_end},
      {"ObjectInstance", &I::object_instance},
      {"Option", &I::option},
      {"PixelFilter", &I::pixel_filter},
      {"ReverseOrientation", &I::reverse_orientation},
      {"Rotate", &I::rotate_directive},
      {"Sampler", &I::sampler},
      {"Scale", &I::scale_directive},
      {"Shape", &I::shape},
      {"SurfaceIntegrator", &I::integrator},
      {"Texture", &I::texture},
      {"Transform", &I::transform_directive},
      {"TransformBegin", &I::transform_begin},
      {"TransformEnd", &I::transform_end},
      {"TransformTimes", &I::transform_times},
      {"Translate", &I::translate_directive},
      {"WorldBegin", &I::world_begin},
      {"WorldEnd", &I::world_end},
  };
  for (const auto& [name, handler] : kDirectives)
    if (name == directive) return handler;
  return nullptr;
}

Status Interpreter::run() {
  auto scene = source(builder_.scene_path());
  if (!scene) return fail(scene.error());
  File file{TokenStream(*std::move(scene))};
  if (auto read = run_directives(file); !read) return read;
  end_states(0);
  if (!in_world_)
    if (auto started = start_world(); !started) return started;
  if (auto added = add_waiting_shapes(); !added) return added;
  tell_unused_attributes();
  if (auto finished = lights_.finish(); !finished) return finished;
  if (shows_emission_only(view_) && !show_emission_only(builder_.scene()))
    report_.warn(view_.integrator->parameters.place(),
                 "media whose scattering has a grid of its own do not weaken light at a maximum depth of 0");
  return {};
}

void Interpreter::tell_unused_attributes() const {
  for (const AttributeUse& each : attributes_)
    if (!*each.is_used) {
      const std::string text = fmt::format("the attribute {} of every {} is used by none; it is ignored",
                                           in_quotes(each.name), each.target);
      report_.warn(each.place, text, text);
    }
}

Result<SourceText> Interpreter::source(const std::string& path) const {
  auto bytes = builder_.read(path);
  if (!bytes) return fail(bytes.error());
  if (!is_gzip(*bytes)) return SourceText{path, *std::move(bytes)};
  SourceText text{path, {}};
  const auto plain = gunzipped(*bytes, text.content);
  if (!plain) return fail(plain.error().code, fmt::format("{} {}", in_quotes(path), plain.error().message));
  return text;
}

Status Interpreter::run_directives(File& file) {
  while (true) {
    file.tokens.release_ended();
    const auto token = file.tokens.next();
    if (!token) return at(file, token.error());
    if (token->is(Token::Kind::kEnd)) return {};
    file.directive = file.tokens.place();
    if (!token->is(Token::Kind::kWord))
      return report_.error(place(file), fmt::format("expected a directive, got {}", in_quotes(token->text)));
    const Handler handler = handler_of(token->text);
    if (handler == nullptr)
      return report_.error(place(file), fmt::format("the directive {} is not known", in_quotes(token->text)));
    if (auto done = (this->*handler)(file); !done) return done;
  }
}

Result<SourceText> Interpreter::named_source(File& file) {
  const auto name = text(file, false);
  if (!name) return fail(name.error());
  if (outer_files_ + file.tokens.depth() > kMaxIncludeDepth)
    return report_.error(place(file),
                         fmt::format("files include each other more than {} deep", kMaxIncludeDepth));
  if (++files_ > kMaxFiles)
    return report_.error(place(file), fmt::format("more than {} files are included", kMaxFiles));
  const auto path = find_file(builder_, place(file), *name);
  if (!path)
    return fail(ErrorCode::kNotFound,
                fmt::format("{}: the file {} does not exist", report_.shown(place(file)), in_quotes(*name)));
  auto read = source(*path);
  if (!read) return report_.error(place(file), read.error().message);
  return read;
}

Status Interpreter::include_file(File& file) {
  auto source = named_source(file);
  if (!source) return fail(source.error());
  file.tokens.include(*std::move(source));
  return {};
}

// What an imported file changes ends with it, but for what it names.
Status Interpreter::import_file(File& file) {
  auto source = named_source(file);
  if (!source) return fail(source.error());
  const GraphicsState before = state_;
  File imported{TokenStream(*std::move(source))};
  outer_files_ += file.tokens.depth();
  const std::size_t states = saved_.size();
  const auto object = object_;
  if (auto done = run_directives(imported); !done) return done;
  end_states(states);
  object_ = object;
  outer_files_ -= file.tokens.depth();
  state_ = before;
  return {};
}

tl::unexpected<Error> Interpreter::at(const File& file, const Error& error) const {
  return fail(error.within(report_.shown(file.tokens.place())));
}

Result<std::string> Interpreter::text(File& file, bool without_escapes) {
  const auto token = file.tokens.next();
  if (!token) return at(file, token.error());
  if (token->is(Token::Kind::kString)) return without_escapes ? token->value() : std::string(token->text);
  return report_.error(place(file),
                       fmt::format("expected a name in double quotes, got {}", in_quotes(token->text)));
}

Result<std::vector<float>> Interpreter::numbers(File& file, std::size_t count) {
  std::vector<float> values;
  auto token = file.tokens.peek();
  const bool in_brackets = token && token->is(Token::Kind::kOpen);
  if (in_brackets) token = file.tokens.next();
  while (values.size() < count) {
    token = file.tokens.next();
    if (!token) return at(file, token.error());
    const auto number = token->is(Token::Kind::kWord) ? parse_number(token->text) : std::nullopt;
    if (!number)
      return report_.error(place(file),
                           fmt::format("expected {} numbers, got {}", count, in_quotes(token->text)));
    values.push_back(*number);
  }
  if (!in_brackets) return values;
  token = file.tokens.next();
  if (!token) return at(file, token.error());
  if (!token->is(Token::Kind::kClose))
    return report_.error(place(file),
                         fmt::format("expected ']' after {} numbers, got {}", count, in_quotes(token->text)));
  return values;
}

Result<Parameters> Interpreter::parameters(File& file) {
  auto parsed = parse_parameters(file.tokens, place(file), state_.color_space);
  if (!parsed) return at(file, parsed.error());
  return parsed;
}

Result<Parameters> Interpreter::parameters(File& file, AttributeTarget target) {
  auto parsed = parameters(file);
  if (parsed) parsed->set_defaults(state_.defaults_of(target));
  return parsed;
}

Result<KindAndParameters> Interpreter::kind_and_parameters(File& file) {
  auto kind = text(file);
  if (!kind) return fail(kind.error());
  auto given = parameters(file);
  if (!given) return fail(given.error());
  return KindAndParameters{std::move(*kind), std::move(*given)};
}

Status Interpreter::read_setting(File& file, std::optional<KindAndParameters>& setting) {
  auto read = kind_and_parameters(file);
  if (!read) return fail(read.error());
  if (in_world_) report_.warn(place(file), "a setting of the render after WorldBegin has no effect");
  setting = std::move(*read);
  return {};
}

// --- Before WorldBegin

Status Interpreter::accelerator(File& file) {
  if (const auto read = kind_and_parameters(file); !read) return fail(read.error());
  return {};
}

Status Interpreter::camera(File& file) {
  if (auto read = read_setting(file, view_.camera); !read) return read;
  const auto start = inverse(state_.transform.start), end = inverse(state_.transform.end);
  if (!start || !end) return report_.error(place(file), "the transformation of the camera has no inverse");
  if (in_world_) return {};
  view_.world_from_camera = {*start, *end};
  coordinate_systems_["camera"] = view_.world_from_camera;
  camera_medium_ = state_.outside_medium;
  camera_medium_place_ = place(file);
  return {};
}

Status Interpreter::film(File& file) {
  return read_setting(file, view_.film);
}
Status Interpreter::integrator(File& file) {
  return read_setting(file, view_.integrator);
}
Status Interpreter::pixel_filter(File& file) {
  return read_setting(file, view_.filter);
}
Status Interpreter::sampler(File& file) {
  return read_setting(file, view_.sampler);
}

// An option has a name and a value: "seed" 7. They may also be written as a parameter: "integer seed" 7.
Result<Parameters> Interpreter::option_value(File& file) {
  const auto name = file.tokens.peek();
  if (!name) return at(file, name.error());
  if (!name->is(Token::Kind::kString) || name->text.find(' ') != std::string_view::npos)
    return parameters(file);
  Parameter option;
  option.name = without_separators(*text(file));
  option.place = file.tokens.place();
  const auto value = file.tokens.next();
  if (!value) return at(file, value.error());
  if (value->is(Token::Kind::kString)) {
    option.type = "string";
    option.strings = {value->value()};
  } else if (value->text == "true" || value->text == "false") {
    option.type = "bool";
    option.booleans = {value->text == "true"};
  } else if (const auto number = parse_number(value->text)) {
    option.type = "float";
    option.floats = {*number};
  } else {
    return report_.error(place(file), fmt::format("the option {} needs a value, got {}",
                                                  in_quotes(option.name), in_quotes(value->text)));
  }
  Parameters given(place(file));
  given.add(std::move(option));
  return given;
}

Status Interpreter::option(File& file) {
  const auto given = option_value(file);
  if (!given) return fail(given.error());
  // What does not change the mean of the image.
  for (const char* known :
       {"disablepixeljitter", "disabletexturefiltering", "disablewavelengthjitter", "msereferenceimage",
        "msereferenceout", "rendercoordsys", "pixelstats", "wavefront", "displacementedgescale"})
    given->find(known);
  if (given->has("seed"))
    builder_.scene().settings.seed =
        static_cast<std::uint64_t>(given->integer_in("seed", 0, 0, std::numeric_limits<int>::max()));
  report_.tell(*given, "the options");
  return {};
}

Status Interpreter::color_space(File& file) {
  const auto name = text(file);
  if (!name) return fail(name.error());
  if (spectra::to_rec709(*name)) {
    state_.color_space = *name;
  } else {
    report_.warn(place(file), fmt::format("the colour space {} is not known; {} remains", in_quotes(*name),
                                          in_quotes(state_.color_space)));
  }
  return {};
}

Status Interpreter::world_begin(File& file) {
  if (in_world_) return report_.error(place(file), "WorldBegin appears twice");
  state_.transform = {};
  coordinate_systems_["world"] = {};
  state_.is_start_active = state_.is_end_active = true;
  return start_world();
}

Status Interpreter::start_world() {
  in_world_ = true;
  // The defaults of directives that are not given name the scene file.
  if (!view_.camera)
    view_.camera = KindAndParameters{
        "perspective", Parameters({std::make_shared<const std::string>(builder_.scene_path()), 0})};
  const Exposure exposure = convert_view(view_, builder_, report_);
  lights_.set_exposure(exposure);
  media_.set_exposure(exposure);
  if (camera_medium_place_)
    builder_.scene().camera_medium = media_.find(camera_medium_, *camera_medium_place_);
  return {};
}

// Version 3 ended the world.
Status Interpreter::world_end(File&) {
  return {};
}

// --- State

Status Interpreter::push_state(const File& file, std::string_view begin) {
  if (saved_.size() >= kMaxSavedStates)
    return report_.error(place(file),
                         fmt::format("attributes are nested more than {} deep", kMaxSavedStates));
  saved_.push_back({state_, place(file), begin});
  return {};
}

Status Interpreter::pop_state(const File& file, bool is_attribute) {
  if (saved_.empty() || saved_.back().is_attribute() != is_attribute)
    return report_.error(place(file), "an end of attributes, transformations or objects has no begin");
  GraphicsState& saved = saved_.back().state;
  if (is_attribute) {
    state_ = std::move(saved);
  } else {
    state_.transform = saved.transform;
    state_.is_start_active = saved.is_start_active;
    state_.is_end_active = saved.is_end_active;
  }
  saved_.pop_back();
  return {};
}

void Interpreter::end_states(std::size_t count) {
  for (std::size_t i = count; i < saved_.size(); ++i) {
    const std::string text = fmt::format("{} has no end; it ends with the file", saved_[i].begin);
    report_.warn(saved_[i].place, text, text);
  }
  saved_.resize(std::min(count, saved_.size()));
}

Status Interpreter::attribute_begin(File& file) {
  return push_state(file, "AttributeBegin");
}
Status Interpreter::attribute_end(File& file) {
  return pop_state(file, true);
}
Status Interpreter::transform_begin(File& file) {
  return push_state(file, "TransformBegin");
}
Status Interpreter::transform_end(File& file) {
  return pop_state(file, false);
}

Status Interpreter::attribute(File& file) {
  const auto name = text(file);
  if (!name) return fail(name.error());
  auto given = parameters(file);
  if (!given) return fail(given.error());
  const auto target = attribute_target(*name);
  if (!target)
    return report_.error(place(file), fmt::format("the attributes of {} are not known", in_quotes(*name)));
  auto& defaults = state_.defaults[static_cast<std::size_t>(*target)];
  if ((defaults ? count_values(*defaults) : 0) + count_values(*given) > kMaxDefaults)
    return report_.error(place(file),
                         fmt::format("there are more than {} values of default parameters", kMaxDefaults));
  given->share_use();
  for (const Parameter& parameter : given->list())
    attributes_.push_back({parameter.place, *name, parameter.name, parameter.is_used_anywhere});
  defaults = joined(defaults, *given);
  return {};
}

Status Interpreter::reverse_orientation(File&) {
  state_.reverse_orientation = !state_.reverse_orientation;
  return {};
}

}  // namespace tessera::core::pbrt
