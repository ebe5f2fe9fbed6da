// SPDX-License-Identifier: Apache-2.0
#include "client/farm/label_option.hpp"

#include <vector>

namespace tessera::client {

void add_label_option(CLI::App& command, const std::string& what, Labels& labels) {
  command
      .add_option_function<std::vector<std::string>>(
          "--label",
          [&labels](const std::vector<std::string>& texts) {
            for (const std::string& text : texts) {
              const std::size_t equals = text.find('=');
              if (equals == std::string::npos || equals == 0)
                throw CLI::ValidationError("--label", "must be KEY=VALUE; got '" + text + "'");
              const auto [label, is_new] = labels.emplace(text.substr(0, equals), text.substr(equals + 1));
              if (!is_new)
                throw CLI::ValidationError(
                    "--label", "a job has one value of a label; '" + label->first + "' is given twice");
            }
          },
          what)
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false)
      ->take_all();
}

}  // namespace tessera::client
