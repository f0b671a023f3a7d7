#include "program.hpp"

#ifdef _WIN32
#define NOMINMAX
#include <windows.h>
// after windows.h
#include <shellapi.h>

#include <string>
#include <vector>

namespace {

// The arguments as the rest of the program takes them, in UTF-8.
std::vector<std::string> utf8_arguments() {
  int count = 0;
  wchar_t** wide = CommandLineToArgvW(GetCommandLineW(), &count);
  std::vector<std::string> arguments;
  for (int i = 0; i < count; ++i) {
    std::string text(WideCharToMultiByte(CP_UTF8, 0, wide[i], -1, nullptr, 0, nullptr, nullptr), '\0');
    WideCharToMultiByte(CP_UTF8, 0, wide[i], -1, text.data(), static_cast<int>(text.size()), nullptr, nullptr);
    text.pop_back();  // the end of the string
    arguments.push_back(std::move(text));
  }
  LocalFree(wide);
  return arguments;
}

}  // namespace

int main() {
  SetConsoleOutputCP(CP_UTF8);
  std::vector<std::string> arguments = utf8_arguments();
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  return csrbf::app::run_program(static_cast<int>(arguments.size()), pointers.data());
}
#else
int main(int argc, char** argv) {
  return csrbf::app::run_program(argc, argv);
}
#endif
