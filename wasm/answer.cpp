#include "answer.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/version.hpp"

#include <emscripten.h>

#include <new>

// The listener is set for the time of a call, by index.js. It returns whether to go on.
EM_JS(int, csrbf_listen, (const char* stage, double fraction),
      { return Module["listener"] ? Module["listener"](UTF8ToString(stage), fraction) : 1; });

namespace csrbf::wasm {

const char* Answer::text() {
  text_ = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  return text_.c_str();
}

void Answer::add(const std::string& name, const char* type, const void* data, std::size_t count) {
  json["arrays"].push_back({{"name", name},
                            {"type", type},
                            {"address", count > 0 ? reinterpret_cast<std::uintptr_t>(data) : 0},
                            {"count", count}});
}

Progress progress() {
  return
      [](std::string_view stage, double fraction) { return csrbf_listen(std::string(stage).c_str(), fraction) != 0; };
}

void describe_exception(Json& json) {
  const auto describe = [&](const char* name, const char* message) { json = {{"name", name}, {"error", message}}; };
  try {
    throw;
  } catch (const InvalidInput& e) {
    describe("InvalidInput", e.what());
  } catch (const SolverFailure& e) {
    describe("SolverFailure", e.what());
  } catch (const IoError& e) {
    describe("IoError", e.what());
  } catch (const Cancelled& e) {
    describe("Cancelled", e.what());
  } catch (const std::bad_alloc&) {
    describe("Error", "out of memory: a page has at most 4 GB");
  } catch (const std::exception& e) {
    describe("Error", e.what());
  }
}

}  // namespace csrbf::wasm

extern "C" {

EMSCRIPTEN_KEEPALIVE const char* csrbf_text(csrbf::wasm::Answer* answer) {
  return answer->text();
}
EMSCRIPTEN_KEEPALIVE void csrbf_release(csrbf::wasm::Answer* answer) {
  delete answer;
}
EMSCRIPTEN_KEEPALIVE const char* csrbf_version() {
  return CSRBF_VERSION;
}
}
