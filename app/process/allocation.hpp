#pragma once

namespace csrbf::app {

/// Keeps freed memory for what is allocated next: otherwise large work arrays that come and go are mapped, page by
/// page, each time. begin_stage() of a Session gives it back.
void keep_freed_memory();

}  // namespace csrbf::app
