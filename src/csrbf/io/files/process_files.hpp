#pragma once

#include <functional>
#include <string>

namespace csrbf {

// What a process says about its files before it reads and writes them.

/// From now on the file of this path counts as one with this extension (".las"), whatever its name: pipes and names
/// without an extension. "-" is standard input or output.
void assume_format(const std::string& path, const std::string& extension);

// File access when several processes do the same computation: one of them reads and writes for all.

/// From now on read_file() calls `reader`, except inside a parallel loop; empty: it reads the file itself (default).
void set_file_reader(std::function<std::string(const std::string& path)> reader);

/// What read_file() does without a reader.
std::string read_file_here(const std::string& path);

/// From now on files written by this process (AtomicFile) are discarded.
void discard_files();

}  // namespace csrbf
