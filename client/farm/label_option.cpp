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
              labels[text.substr(0, equals)] = text.substr(equals + 1);
            }
          },
          what)
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false)
      ->take_all();
}

}  // namespace tessera::client
