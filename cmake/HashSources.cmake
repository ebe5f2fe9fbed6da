# SPDX-License-Identifier: Apache-2.0
# cmake -DFOLDER=... -DSOURCES="a;b;..." -DHEADER=... -P HashSources.cmake: writes a header that has the SHA-256 of
# these sources as a string.
set(hashes "")
foreach(source IN LISTS SOURCES)
  file(SHA256 ${FOLDER}/${source} hash)
  string(APPEND hashes "${source} ${hash}\n")
endforeach()
string(SHA256 hash "${hashes}")
file(WRITE ${HEADER} "#define TESSERA_SOURCES_HASH \"${hash}\"\n")
