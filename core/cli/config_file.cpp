// SPDX-License-Identifier: Apache-2.0
#include "core/cli/config_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>

#include "core/base/printable.hpp"
#include "core/base/suggestion.hpp"
#include "core/cli/option_table.hpp"

namespace tessera::cli {
namespace {

const std::string kConfigOption = "--config";
constexpr std::size_t kMaxFileBytes = std::size_t{1} << 20;
constexpr std::string_view kBlank = " \t\r";

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlank);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlank) + 1 - begin);
}

// Throws CLI::ValidationError.
std::string read_text(const std::string& file) {
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  std::string text(kMaxFileBytes + 1, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!stream.is_open() || stream.bad() || (!stream && !stream.eof()))
    throw CLI::ValidationError(
        fmt::format("{}: cannot be read: {}", file, std::strerror(errno == 0 ? EIO : errno)));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  if (text.size() > kMaxFileBytes)
    throw CLI::ValidationError(file + ": it is longer than 1 MiB, so it is no file of options");
  return text;
}

std::vector<std::string> configurable_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    if (option->get_configurable() && !option->get_lnames().empty())
      names.push_back(option->get_lnames().front());
  return names;
}

// Sets the options of one file. Those that the command line or the environment has set stay as they are.
class ConfigReader {
 public:
  ConfigReader(CLI::App& app, const std::string& file) : app_(app), file_(file) {}

  void read() {
    const auto lines = parse_config(read_text(file_));
    if (!lines) throw CLI::ValidationError(file_ + ":" + lines.error().message);
    for (const ConfigLine& line : *lines) apply(line);
  }

 private:
  struct Setting {
    int line;         // where the file sets it last
    bool is_decided;  // by the command line or the environment
  };

  [[noreturn]] void refuse(const ConfigLine& line, const std::string& what) const {
    throw CLI::ValidationError(fmt::format("{}:{}: {}", file_, line.number, what));
  }

  CLI::Option& find(const ConfigLine& line) const {
    if (line.name.starts_with('-')) refuse(line, core::in_quotes(line.name) + " must stand without dashes");
    CLI::Option* const option = app_.get_option_no_throw("--" + line.name);
    if (option != nullptr && option->get_configurable()) return *option;
    if (option != nullptr) refuse(line, core::in_quotes(line.name) + " is for the command line alone");
    const std::vector<std::string> names = configurable_names(app_);
    refuse(line, "there is no option " + core::in_quotes(line.name) +
                     core::suggestion(line.name, {names.begin(), names.end()}));
  }

  static bool is_flag(const CLI::Option& option) { return option.get_items_expected_max() == 0; }

  void check_value(const CLI::Option& option, const ConfigLine& line) const {
    if (is_flag(option) && line.value)
      refuse(line, fmt::format("'{}' takes no value; remove the line to turn it off", line.name));
    if (!is_flag(option) && (!line.value || line.value->empty()))
      refuse(line, fmt::format("'{0}' needs a value: {0} = VALUE", line.name));
  }

  void apply(const ConfigLine& line) {
    CLI::Option& option = find(line);
    check_value(option, line);
    const auto [setting, is_first] = settings_.try_emplace(&option, Setting{line.number, !option.empty()});
    const bool is_repeatable = !is_flag(option) && option.get_expected_max() > 1;
    if (!is_first && !is_repeatable)
      refuse(line, fmt::format("'{}' is already set in line {}", line.name, setting->second.line));
    setting->second.line = line.number;
    if (setting->second.is_decided) return;
    try {
      option.add_result(line.value.value_or("true"));
      option.run_callback();
    } catch (const CLI::ParseError& error) {
      const std::string what = error.what();
      refuse(line, what.starts_with("--") ? what.substr(2) : what);
    }
  }

  CLI::App& app_;
  const std::string file_;
  std::map<const CLI::Option*, Setting> settings_;
};

}  // namespace

core::Result<std::vector<ConfigLine>> parse_config(std::string_view text) {
  std::vector<ConfigLine> lines;
  std::istringstream stream{std::string(text)};
  int number = 0;
  for (std::string whole; std::getline(stream, whole);) {
    ++number;
    const std::string_view line = trimmed(whole);
    if (line.empty() || line.front() == '#') continue;
    const std::size_t equals = line.find('=');
    ConfigLine read{.number = number, .name = std::string(trimmed(line.substr(0, equals)))};
    if (equals != std::string_view::npos) read.value = trimmed(line.substr(equals + 1));
    if (read.name.empty() || read.name.find_first_of(kBlank) != std::string::npos ||
        !core::is_printable(line))
      return core::fail(core::ErrorCode::kInvalidArgument,
                        fmt::format("{}: it must be NAME = VALUE, or the name of a flag; got {}", number,
                                    core::in_quotes(line)));
    lines.push_back(std::move(read));
  }
  return lines;
}

void add_config_option(CLI::App& app) {
  app.add_option_function<std::string>(
         kConfigOption, [&app](const std::string& file) { ConfigReader(app, file).read(); },
         "Read options from this file: NAME = VALUE in each line, with the names of this list without "
         "dashes. "
         "Environment variables and the command line override it")
      ->configurable(false)
      ->envname(variable_of(app.get_name(), kConfigOption))
      ->type_name("FILE");
}

std::string variable_of(const std::string& program, const std::string& option) {
  std::string variable = program + "_" + option.substr(option.find_first_not_of('-'));
  for (char& c : variable)
    c = c == '-' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return variable;
}

void add_environment_variables(CLI::App& app) {
  if (app.get_option_no_throw(kConfigOption) == nullptr) return;
  for (const std::string& name : configurable_names(app)) {
    CLI::Option* const option = app.get_option("--" + name);
    if (option->get_envname().empty()) option->envname(variable_of(app.get_name(), name));
  }
}

}  // namespace tessera::cli
