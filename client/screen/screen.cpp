// SPDX-License-Identifier: Apache-2.0
#include "client/screen/screen.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>

#include "client/console.hpp"
#include "client/text_width.hpp"
#include "core/base/printable.hpp"

namespace tessera::client {
namespace {

constexpr std::chrono::milliseconds kAnswerTimeout{300};
// The caption, and the line of the prompt.
constexpr int kOtherRows = 2;

std::string variable_of(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

ScreenSize size_of_stdout() {
  ScreenSize size;
  winsize window{};
  if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &window) != 0 || window.ws_col == 0 || window.ws_row == 0)
    return size;
  size.columns = window.ws_col;
  size.rows = window.ws_row;
  if (window.ws_xpixel >= window.ws_col) size.cell_width = window.ws_xpixel / window.ws_col;
  if (window.ws_ypixel >= window.ws_row) size.cell_height = window.ws_ypixel / window.ws_row;
  return size;
}

// The terminal without echo and line editing, for as long as this lives.
class RawInput {
 public:
  RawInput() {
    if (::tcgetattr(STDIN_FILENO, &before_) != 0) return;
    termios raw = before_;
    raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    is_raw_ = ::tcsetattr(STDIN_FILENO, TCSANOW, &raw) == 0;
  }
  ~RawInput() {
    if (is_raw_) ::tcsetattr(STDIN_FILENO, TCSANOW, &before_);
  }
  RawInput(const RawInput&) = delete;
  RawInput& operator=(const RawInput&) = delete;
  bool is_raw() const { return is_raw_; }

 private:
  termios before_{};
  bool is_raw_ = false;
};

// The answer to DA1, which practically every terminal gives. Empty if there is none in time.
std::string ask_device_attributes() {
  if (::isatty(STDIN_FILENO) == 0 || ::isatty(STDOUT_FILENO) == 0) return "";
  const RawInput raw;
  if (!raw.is_raw()) return "";
  print_result("\033[c");
  std::string answer;
  const auto until = std::chrono::steady_clock::now() + kAnswerTimeout;
  while (answer.find('c') == std::string::npos) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(until - std::chrono::steady_clock::now());
    pollfd input{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
    char letter = 0;
    if (left.count() <= 0 || ::poll(&input, 1, static_cast<int>(left.count())) <= 0 ||
        ::read(STDIN_FILENO, &letter, 1) != 1)
      return "";
    answer += letter;
  }
  return answer;
}

Graphics detect_graphics() {
  const std::string term = variable_of("TERM"), program = variable_of("TERM_PROGRAM");
  const bool is_multiplexed = !variable_of("TMUX").empty() || !variable_of("STY").empty();
  const bool by_variables = graphics_of(term, program, is_multiplexed, "") != Graphics::kBlocks;
  return graphics_of(term, program, is_multiplexed,
                     by_variables || is_multiplexed ? "" : ask_device_attributes());
}

}  // namespace

Graphics graphics_of(const std::string& term, const std::string& term_program, bool is_multiplexed,
                     const std::string& device_attributes) {
  if (is_multiplexed) return Graphics::kBlocks;
  for (const char* name : {"kitty", "ghostty", "wezterm", "WezTerm"})
    if (term.find(name) != std::string::npos || term_program.find(name) != std::string::npos)
      return Graphics::kKitty;
  const std::string begin = "\033[?";
  if (!device_attributes.starts_with(begin)) return Graphics::kBlocks;
  const std::string attributes =
      ";" + device_attributes.substr(begin.size(), device_attributes.find('c') - begin.size()) + ";";
  return attributes.find(";4;") == std::string::npos ? Graphics::kBlocks : Graphics::kSixel;
}

core::Result<Screen> Screen::open(std::optional<Graphics> graphics) {
  if (!graphics && ::isatty(STDOUT_FILENO) == 0)
    return core::fail(core::ErrorCode::kFailedPrecondition,
                      "stdout is not a terminal: choose what to write with --protocol");
  return Screen(size_of_stdout(), graphics ? *graphics : detect_graphics());
}

int Screen::rows_of(const ScreenImage& image) const {
  const int cell = graphics_ == Graphics::kBlocks ? 2 : size_.cell_height;
  return (image.height + cell - 1) / cell;
}

// Makes room for the image, and puts the cursor at its top left, which is saved.
std::string Screen::begin_frame(int rows) {
  if (rows_ > 0) return "\0338";
  rows_ = rows;
  std::string text;
  for (int i = 0; i < rows; ++i) text += "\n";
  return text + fmt::format("\r\033[{}A\0337", rows);
}

core::Status Screen::show(const core::Image& image, const core::DisplaySettings& display,
                          const std::string& caption, bool is_live) {
  const int rows = std::max(1, size_.rows - kOtherRows);
  const bool blocks = graphics_ == Graphics::kBlocks;
  const ScreenImage screen = fit_to_screen(image, size_.columns * (blocks ? 1 : size_.cell_width),
                                           rows * (blocks ? 2 : size_.cell_height), display);
  const auto drawn = draw(screen, graphics_);
  if (!drawn) return core::fail(drawn.error());
  std::string text = is_live ? "\033[?25l" : "";
  text += begin_frame(rows_of(screen)) + *drawn;
  text += fmt::format("\0338\033[{}B\r\033[K{}", rows_,
                      shortened(core::printable(caption), static_cast<std::size_t>(size_.columns)));
  print_result(text);
  return {};
}

void Screen::close() {
  if (rows_ > 0) print_result("\033[?25h\n");
  rows_ = 0;
}

}  // namespace tessera::client
