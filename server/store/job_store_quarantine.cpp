// SPDX-License-Identifier: Apache-2.0
// The stored quarantine. It changes rarely, so its statements are not kept.
#include <string>
#include <utility>

#include "server/store/job_store_impl.hpp"
#include "server/store/row_codec.hpp"

namespace tessera::store {

core::Status JobStore::write_quarantine(const std::string& id, const std::string& content) {
  return impl_->write([&]() -> core::Status {
    auto write = impl_->writer->database.prepare(
        "INSERT OR REPLACE INTO quarantine (id, content, row_xxh3) VALUES (?1, ?2, ?3)");
    if (!write) return core::fail(write.error());
    return write->bind_text(1, id).bind_blob(2, content).bind(3, as_signed(row_checksum(id, content))).run();
  });
}

core::Status JobStore::delete_quarantine(const std::string& id) {
  return impl_->write([&]() -> core::Status {
    auto remove = impl_->writer->database.prepare("DELETE FROM quarantine WHERE id = ?1");
    if (!remove) return core::fail(remove.error());
    return remove->bind_text(1, id).run();
  });
}

core::Result<std::vector<QuarantineRow>> JobStore::quarantine() {
  const core::MutexLock lock(impl_->reading);
  Database& database = impl_->reader.database;
  std::vector<QuarantineRow> rows;
  const auto exists = database.read_number("SELECT count(*) FROM sqlite_master WHERE name = 'quarantine'");
  if (!exists) return core::fail(exists.error());
  if (*exists == 0) return rows;
  auto list = database.prepare("SELECT id, content, row_xxh3 FROM quarantine ORDER BY id");
  if (!list) return core::fail(list.error());
  const auto read = for_each_row(*list, [&] {
    QuarantineRow row{std::string(list->bytes(0)), std::string(list->bytes(1))};
    row.intact = as_unsigned(list->integer(2)) == row_checksum(row.id, row.content);
    rows.push_back(std::move(row));
  });
  if (!read) return core::fail(read.error());
  return rows;
}

}  // namespace tessera::store
