// SPDX-License-Identifier: Apache-2.0
// Following a job until it is over. Blocks; Ctrl-C ends it.
#pragma once

#include <functional>
#include <string>

#include "client/farm/farm.hpp"
#include "client/notices.hpp"

namespace tessera::client {

// Calls `on_update` with the job as it is and at every change, and answers with it when it is over. A
// coordinator that stops answering is waited for, forever. CANCELLED: interrupted() became true.
core::Result<v1::Job> watch_job(Farm& farm, const std::string& job_id,
                                const std::function<void(const v1::Job&)>& on_update,
                                const std::function<void(const std::string& notice)>& on_notice);

// The same until the scene of the job is validated: the job in whatever state it has then.
core::Result<v1::Job> wait_until_validated(Farm& farm, const v1::Job& submitted,
                                           const std::function<void(const std::string& notice)>& on_notice);

// The same, with the progress line of `tessera render` on stderr, and with notices of other threads.
core::Result<v1::Job> watch_with_progress(Farm& farm, const std::string& job_id, Notices& notices);
core::Result<v1::Job> watch_with_progress(Farm& farm, const std::string& job_id);

// The same, with a line of JSON on stdout for each update, and with notices of other threads. Ends when
// nobody reads stdout.
core::Result<v1::Job> watch_with_lines(Farm& farm, const std::string& job_id, Notices& notices);

// Says on stderr what is wrong with a job that is over, if anything is. The exit status it deserves.
int report_end(const v1::Job& job);

}  // namespace tessera::client
