# SPDX-License-Identifier: Apache-2.0
# cmake -DVERSION=... -DFOLDER=... -DOUTPUT=... -P WriteVersion.cmake: writes the source that core/base/version.hpp
# declares, if it has changed. Adds what `git describe` says of a checkout that is not the tag of the version itself.
find_program(GIT git)
set(text ${VERSION})
if(GIT AND EXISTS ${FOLDER}/.git)
  execute_process(COMMAND ${GIT} -C ${FOLDER} describe --tags --match v${VERSION} --dirty --abbrev=8
    OUTPUT_VARIABLE described OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE status)
  if(status EQUAL 0)
    string(REGEX REPLACE "^v" "" text ${described})
  else()
    execute_process(COMMAND ${GIT} -C ${FOLDER} describe --always --dirty --abbrev=8
      OUTPUT_VARIABLE described OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE status)
    if(status EQUAL 0)
      set(text ${VERSION}-g${described})
    endif()
  endif()
endif()
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT [[
#include "core/base/version.hpp"

namespace tessera::core {

std::string_view version() { return "@text@"; }

}  // namespace tessera::core
]] @ONLY)
