// The program and what draws its files, for the studio in the browser: viewer/src/engine/worker.js calls these.
#include "answer.hpp"
#include "program.hpp"
#include "studio/coarse.hpp"
#include "studio/look.hpp"

#include "csrbf/version.hpp"

#include <emscripten.h>

#include <cstdio>
#include <filesystem>

namespace csrbf::wasm {
namespace {

namespace fs = std::filesystem;

app::Looker& looker() {
  static app::Looker instance;
  return instance;
}

void add_look(Answer& answer, const app::Look& look) {
  const std::string bytes = look.bytes();
  answer.add("bytes", std::vector<std::uint8_t>(bytes.begin(), bytes.end()));
}

// What is in a file, and why it cannot be read, if so.
void describe_file(const std::string& path, Answer& answer) {
  try {
    const bool is_known = app::kind_by_name(path) != "other";
    answer.json["kind"] = is_known ? looker().look(path, 1).header["kind"].get<std::string>() : "other";
  } catch (const std::exception& error) {
    answer.json = {{"kind", "other"}, {"problem", error.what()}};
  }
}

int run_in(const char* folder, const char* arguments) {
  std::vector<std::string> words = Json::parse(arguments).get<std::vector<std::string>>();
  words.insert(words.begin(), "csrbf");
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  fs::current_path(folder);
  const int status = app::run_program(static_cast<int>(words.size()), pointers.data());
  std::fflush(nullptr);
  return status;
}

}  // namespace
}  // namespace csrbf::wasm

extern "C" {

using csrbf::wasm::Answer;

// Runs the program with these arguments, a list in JSON, in a folder; its exit status.
EMSCRIPTEN_KEEPALIVE int csrbf_run(const char* folder, const char* arguments) {
  return csrbf::wasm::run_in(folder, arguments);
}
EMSCRIPTEN_KEEPALIVE Answer* csrbf_look(const char* path, int most) {
  return csrbf::wasm::answer(
      [&](Answer& answer) { csrbf::wasm::add_look(answer, csrbf::wasm::looker().look(path, most)); });
}
EMSCRIPTEN_KEEPALIVE Answer* csrbf_slice(const char* path, int axis, int index, int frame) {
  return csrbf::wasm::answer(
      [&](Answer& answer) { csrbf::wasm::add_look(answer, csrbf::wasm::looker().slice(path, axis, index, frame)); });
}
EMSCRIPTEN_KEEPALIVE Answer* csrbf_describe(const char* path) {
  return csrbf::wasm::answer([&](Answer& answer) { csrbf::wasm::describe_file(path, answer); });
}
EMSCRIPTEN_KEEPALIVE Answer* csrbf_coarse(const char* path, const char* folder) {
  return csrbf::wasm::answer([&](Answer& answer) { answer.json["name"] = csrbf::app::coarse_copy(path, folder); });
}
}
