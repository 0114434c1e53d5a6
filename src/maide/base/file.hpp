// Whole files: reading, and writing so that a crash or a full disk never leaves half a file behind.
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string>
#include <string_view>

#include "maide/base/run_control.hpp"

namespace maide {

// The file's bytes. Throws UsageError "cannot read the file: reason (path)"; a directory is no
// file. A pipe is waited for, its other end too, until `control` says stop (throws Interrupted).
std::string read_file(const std::filesystem::path& path, const RunControl& control = {});

// Puts `content` at `path`, all of it or none: a temporary file beside it, synced, then renamed. A
// symbolic link stays and its target is replaced; a device or pipe is written to directly. Throws
// UsageError "cannot write the file: reason (path)", or Error (inconclusive) where the disk is
// full; an earlier file is then untouched.
void write_file_atomically(const std::filesystem::path& path, std::string_view content);
// As above, for content that need not fit the memory: `write` writes it to the stream. What it
// throws passes, and the file is as it was; a device or pipe may have got a part.
void write_file_atomically(const std::filesystem::path& path,
                           const std::function<void(std::ostream& out)>& write);

// For work that is long and ends with a file: throws the error of write_file_atomically() now, as
// far as it can be foreseen (no such folder, no permission, a folder). Writes nothing.
void check_can_write(const std::filesystem::path& path);

// Whether both names are of one file, there or not.
bool is_same_file(const std::filesystem::path& left, const std::filesystem::path& right);

}  // namespace maide
