// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/xml_default.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>

namespace tessera::core {
namespace {

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
std::string xml_value(std::string value) {
  const auto parsed = nlohmann::json::parse(value, nullptr, false);
  if (parsed.is_string()) value = parsed.get<std::string>();
  if (parsed.is_array()) std::erase_if(value, [](char c) { return c == '[' || c == ']'; });
  std::string escaped;
  for (const char c : value) {
    if (c == '&')
      escaped += "&amp;";
    else if (c == '<')
      escaped += "&lt;";
    else if (c == '"')
      escaped += "&quot;";
    else if (c == '\n')
      escaped += "&#10;";
    else
      escaped += c;
  }
  return escaped;
}

}  // namespace

bool is_xml(std::string_view text) {
  const std::size_t begin = text.find_first_not_of("\xef\xbb\xbf \t\r\n");
  return begin != std::string_view::npos && text[begin] == '<';
}

std::string with_xml_default(std::string xml, const std::string& name, const std::string& value) {
  const auto begin = behind_root_tag(xml);
  if (!begin) return xml;
  xml.insert(*begin, fmt::format("<default name=\"{}\" value=\"{}\"/>", name, xml_value(value)));
  return xml;
}

}  // namespace tessera::core
