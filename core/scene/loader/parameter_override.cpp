// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/parameter_override.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>
#include <optional>
#include <variant>

#include "core/scene/import/scene_format.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core {
namespace {

using Step = std::variant<std::string, std::size_t>;  // a key, or an index

tl::unexpected<Error> invalid_override(const std::string& path, const std::string& what) {
  return fail(ErrorCode::kInvalidArgument, fmt::format("{}: {}", path, what));
}

bool is_json(std::string_view text) {
  constexpr bool kIgnoreComments = true;
  return nlohmann::json::accept(text.begin(), text.end(), kIgnoreComments);
}

bool is_word(std::string_view text) {
  const auto is_letter = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-' || c == '.' || c == '/' || c == '+';
  };
  return !text.empty() && std::all_of(text.begin(), text.end(), is_letter);
}

// "shapes[2].transform" as its steps; empty if it is no path.
std::vector<Step> steps_of(std::string_view path) {
  std::vector<Step> steps;
  while (!path.empty()) {
    if (path.front() == '[') {
      std::size_t index = 0;
      const auto [end, error] = std::from_chars(path.data() + 1, path.data() + path.size(), index);
      if (error != std::errc() || end == path.data() + path.size() || *end != ']') return {};
      steps.emplace_back(index);
      path.remove_prefix(static_cast<std::size_t>(end - path.data()) + 1);
    } else {
      if (!steps.empty()) {
        if (path.front() != '.') return {};
        path.remove_prefix(1);
      }
      const std::size_t size = std::min(path.find_first_of(".["), path.size());
      if (size == 0) return {};
      steps.emplace_back(std::string(path.substr(0, size)));
      path.remove_prefix(size);
    }
  }
  return steps;
}

std::string json_string(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

// Reads over a text that is valid JSON with comments.
class Cursor {
 public:
  explicit Cursor(std::string_view text) : text_(text) { skip_blanks(); }

  std::size_t position() const { return at_; }
  char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
  // Takes the character and what is blank behind it.
  void take() {
    ++at_;
    skip_blanks();
  }
  bool take_if(char c) {
    if (peek() != c) return false;
    take();
    return true;
  }
  // The end of the value here, and then what is blank behind it is skipped.
  std::size_t skip_value();
  std::string take_key();

 private:
  void skip_blanks();
  void skip_string();

  std::string_view text_;
  std::size_t at_ = 0;
};

void Cursor::skip_blanks() {
  while (at_ < text_.size()) {
    const std::string_view rest = text_.substr(at_);
    if (rest.starts_with("//")) {
      at_ += std::min(rest.find('\n'), rest.size());
    } else if (rest.starts_with("/*")) {
      at_ += std::min(rest.find("*/", 2), rest.size() - 2) + 2;
    } else if (rest.starts_with("\xef\xbb\xbf")) {  // a byte order mark
      at_ += 3;
    } else if (rest.front() == ' ' || rest.front() == '\t' || rest.front() == '\r' || rest.front() == '\n') {
      ++at_;
    } else {
      return;
    }
  }
}

void Cursor::skip_string() {
  for (++at_; at_ < text_.size() && text_[at_] != '"'; ++at_)
    if (text_[at_] == '\\') ++at_;
  at_ = std::min(at_ + 1, text_.size());
}

std::string Cursor::take_key() {
  const std::size_t begin = at_;
  skip_string();
  const auto key = nlohmann::json::parse(text_.substr(begin, at_ - begin), nullptr, false);
  skip_blanks();
  take_if(':');
  return key.is_string() ? key.get<std::string>() : std::string();
}

std::size_t Cursor::skip_value() {
  int depth = 0;
  std::size_t end = at_;
  do {
    const char c = peek();
    if (c == '"') {
      skip_string();
    } else if (c == '{' || c == '[') {
      ++depth, ++at_;
    } else if (c == '}' || c == ']') {
      --depth, ++at_;
    } else if (c == ',' || c == ':') {
      ++at_;
    } else {
      at_ += std::min(text_.substr(at_).find_first_of(",:{}[]\" \t\r\n/"), text_.size() - at_);
    }
    end = at_;
    skip_blanks();
  } while (depth > 0 && at_ < text_.size());
  return end;
}

// Part of the text to replace.
struct Splice {
  std::size_t begin = 0, end = 0;
  std::string text;
};

// The value as a member of objects that do not exist yet; nothing if there are indices among the steps.
std::optional<std::string> nested(std::span<const Step> steps, std::string value) {
  for (auto step = steps.rbegin(); step != steps.rend(); ++step) {
    const auto* key = std::get_if<std::string>(&*step);
    if (key == nullptr) return std::nullopt;
    value = step + 1 == steps.rend() ? fmt::format("{}: {}", json_string(*key), value)
                                     : fmt::format("{{{}: {}}}", json_string(*key), value);
  }
  return value;
}

class SpliceFinder {
 public:
  SpliceFinder(std::string_view text, const ParameterOverride& wanted)
      : cursor_(text), wanted_(wanted), steps_(steps_of(wanted.path)) {}

  Result<Splice> find();

 private:
  // Moves to the member or element; without one, the splice that adds a member, or an error.
  std::optional<Result<Splice>> enter(const std::string& key, std::size_t step);
  std::optional<Result<Splice>> enter(std::size_t index, std::size_t step);
  // "camera" for the first step of "camera.position".
  std::string path_to(std::size_t step) const;

  Cursor cursor_;
  const ParameterOverride& wanted_;
  std::vector<Step> steps_;
};

std::string SpliceFinder::path_to(std::size_t step) const {
  std::string path;
  for (std::size_t i = 0; i < step; ++i) {
    const auto* key = std::get_if<std::string>(&steps_[i]);
    path += key == nullptr ? fmt::format("[{}]", *std::get_if<std::size_t>(&steps_[i]))
                           : (path.empty() ? "" : ".") + *key;
  }
  return path.empty() ? "the scene" : in_quotes(path);
}

std::optional<Result<Splice>> SpliceFinder::enter(const std::string& key, std::size_t step) {
  if (cursor_.peek() != '{')
    return invalid_override(wanted_.path, path_to(step) + " is no object, so it has no keys");
  const std::size_t inside = cursor_.position() + 1;
  cursor_.take();
  const bool is_empty = cursor_.peek() == '}';
  while (cursor_.peek() == '"') {
    if (cursor_.take_key() == key) return std::nullopt;
    cursor_.skip_value();
    cursor_.take_if(',');
  }
  const auto member = nested(std::span(steps_).subspan(step), wanted_.value);
  if (!member) return invalid_override(wanted_.path, path_to(step + 1) + " is not in the scene");
  return Splice{inside, inside, is_empty ? *member : *member + ", "};
}

std::optional<Result<Splice>> SpliceFinder::enter(std::size_t index, std::size_t step) {
  if (cursor_.peek() != '[')
    return invalid_override(wanted_.path, path_to(step) + " is no list, so it has no elements");
  cursor_.take();
  std::size_t count = 0;
  for (; cursor_.peek() != ']' && cursor_.peek() != '\0'; ++count) {
    if (count == index) return std::nullopt;
    cursor_.skip_value();
    cursor_.take_if(',');
  }
  return invalid_override(wanted_.path,
                          fmt::format("{} has {} elements, counted from 0", path_to(step), count));
}

Result<Splice> SpliceFinder::find() {
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    auto ended = std::visit([&](const auto& step) { return enter(step, i); }, steps_[i]);
    if (ended) return *std::move(ended);
  }
  const std::size_t begin = cursor_.position();
  return Splice{begin, cursor_.skip_value(), wanted_.value};
}

// The position behind the start tag of the root element; nothing if there is none that has content.
std::optional<std::size_t> behind_root_tag(std::string_view xml) {
  std::size_t at = 0;
  while ((at = xml.find('<', at)) != std::string_view::npos) {
    const std::string_view rest = xml.substr(at);
    if (rest.starts_with("<!--")) {
      at = xml.find("-->", at);
    } else if (rest.starts_with("<?") || rest.starts_with("<!")) {
      ++at;
    } else {
      char quote = '\0';
      for (std::size_t i = at; i < xml.size(); ++i) {
        if (quote == '\0' && xml[i] == '>') return xml[i - 1] == '/' ? std::nullopt : std::optional(i + 1);
        if (quote == '\0' && (xml[i] == '"' || xml[i] == '\''))
          quote = xml[i];
        else if (xml[i] == quote)
          quote = '\0';
      }
      return std::nullopt;
    }
  }
  return std::nullopt;
}

// The value as XML writes it: texts without quotes, lists without brackets.
std::string xml_value(const std::string& json) {
  const auto parsed = nlohmann::json::parse(json, nullptr, false);
  std::string value = parsed.is_string() ? parsed.get<std::string>() : json;
  if (parsed.is_array()) std::erase_if(value, [](char c) { return c == '[' || c == ']'; });
  std::string escaped;
  for (const char c : value) {
    if (c == '&')
      escaped += "&amp;";
    else if (c == '<')
      escaped += "&lt;";
    else if (c == '"')
      escaped += "&quot;";
    else
      escaped += c;
  }
  return escaped;
}

bool is_xml(std::string_view text) {
  const std::size_t begin = text.find_first_not_of("\xef\xbb\xbf \t\r\n");
  return begin != std::string_view::npos && text[begin] == '<';
}

Result<std::string> with_xml_defaults(std::string xml, std::span<const ParameterOverride> overrides) {
  const auto begin = behind_root_tag(xml);
  if (!begin) return xml;
  std::string defaults;
  for (const ParameterOverride& wanted : overrides) {
    const auto steps = steps_of(wanted.path);
    if (steps.size() != 1 || !is_word(wanted.path))
      return invalid_override(wanted.path, "a Mitsuba scene has parameters with plain names, as -D spp=64");
    const bool is_used = xml.find("$" + wanted.path) != std::string::npos ||
                         xml.find("\"" + wanted.path + "\"") != std::string::npos ||
                         xml.find("<include") != std::string::npos;
    if (!is_used) return invalid_override(wanted.path, "the scene has no such parameter");
    defaults += fmt::format("<default name=\"{}\" value=\"{}\"/>", wanted.path, xml_value(wanted.value));
  }
  return xml.insert(*begin, defaults);
}

// Whether parameters of files with this name can be replaced, as far as the name tells.
bool has_parameters(const std::string& path, std::string_view bytes) {
  const auto format = format_by_ending(path);
  return !format || *format == SceneFormat::kTessera || *format == SceneFormat::kMitsuba ||
         (*format == SceneFormat::kGltf && is_json(bytes));
}

}  // namespace

Result<ParameterOverride> parse_override(std::string_view text) {
  const std::size_t equals = std::min(text.find('='), text.size());
  ParameterOverride parsed{std::string(text.substr(0, equals)), ""};
  if (equals == text.size() || steps_of(parsed.path).empty())
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("must be PATH=VALUE such as camera.position=[0,1,5]; got '{}'", text));
  parsed.value = text.substr(equals + 1);
  std::replace(parsed.value.begin(), parsed.value.end(), '\n', ' ');
  if (is_json(parsed.value)) return parsed;
  if (!is_word(parsed.value))
    return invalid_override(
        parsed.path,
        fmt::format("the value must be written as in a scene file: a number, [x, y, z], \"a text\"; got {}",
                    in_quotes(parsed.value)));
  parsed.value = json_string(parsed.value);
  return parsed;
}

Result<std::string> with_overrides(std::string text, std::span<const ParameterOverride> overrides) {
  if (is_xml(text)) return with_xml_defaults(std::move(text), overrides);
  if (!is_json(text)) return text;
  for (const ParameterOverride& wanted : overrides) {
    const auto splice = SpliceFinder(text, wanted).find();
    if (!splice) return fail(splice.error());
    // Lines of the old value stay, so that places in messages are those of the file.
    const auto lines = std::count(text.begin() + static_cast<std::ptrdiff_t>(splice->begin),
                                  text.begin() + static_cast<std::ptrdiff_t>(splice->end), '\n');
    text.replace(splice->begin, splice->end - splice->begin,
                 splice->text + std::string(static_cast<std::size_t>(lines), '\n'));
  }
  return text;
}

Result<std::string> OverriddenAssets::read(const std::string& path) {
  auto bytes = inner_.read(path);
  if (!bytes || path != scene_path_ || overrides_.empty()) return bytes;
  if (!has_parameters(path, *bytes))
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("{} has no parameters that -D can replace; those of .json, .gltf and Mitsuba's .xml "
                    "files can be",
                    in_quotes(path)));
  return with_overrides(std::move(*bytes), overrides_);
}

}  // namespace tessera::core
