// SPDX-License-Identifier: Apache-2.0
// The tokens of a file, with those of each file that it includes in its place: a directive may begin in an
// included file and end in the one that includes it. Not thread-safe.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.hpp"
#include "core/scene/pbrt/tokenizer.hpp"

namespace tessera::core::pbrt {

// A line of a file of the scene. `file` is its path in the scene's assets.
struct Place {
  std::shared_ptr<const std::string> file;
  int line = 0;
};

struct SourceText {
  std::string path, content;
};

class TokenStream {
 public:
  explicit TokenStream(SourceText source) { include(std::move(source)); }

  // Continues with the tokens of `source`. There must be no token ahead.
  void include(SourceText source);
  // The next token; kEnd at the end of the outermost file. Its text is valid until release_ended().
  Result<Token> next();
  // The next token without consuming it.
  Result<Token> peek();
  // Where the last token, or the error, is.
  Place place() const { return {open_.back()->path, line_}; }
  // How many files are open.
  std::size_t depth() const { return open_.size(); }
  // Frees the files of which all tokens have been consumed.
  void release_ended() { ended_.clear(); }

 private:
  struct File {
    explicit File(SourceText source);

    std::shared_ptr<const std::string> path;
    std::string content;
    Tokenizer tokens;
  };

  // Closes the last file if `token` is the end of an included one.
  bool close_ended(const Result<Token>& token);

  std::vector<std::unique_ptr<File>> open_, ended_;
  int line_ = 0;
};

}  // namespace tessera::core::pbrt
