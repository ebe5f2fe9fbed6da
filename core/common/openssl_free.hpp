// SPDX-License-Identifier: Apache-2.0
// Owners of OpenSSL's objects: std::unique_ptr<X509, FreeWith<X509_free>>.
#pragma once

namespace tessera::common {

template <auto kFree>
struct FreeWith {
  template <typename Object>
  void operator()(Object* object) const {
    kFree(object);
  }
};

}  // namespace tessera::common
