#pragma once

#include <functional>
#include <string>

namespace csrbf {

// Files where several processes make the same computation: one of them reads and writes for all.

/// From now on read_file() asks `reader`, unless it is called inside a parallel loop; empty: it reads the file itself
/// (default).
void set_file_reader(std::function<std::string(const std::string& path)> reader);

/// What read_file() does without a reader.
std::string read_file_here(const std::string& path);

/// From now on files written by this process (AtomicFile) go nowhere.
void discard_files();

}  // namespace csrbf
