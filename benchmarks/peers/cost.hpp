#pragma once

#include <sys/resource.h>

#include <chrono>
#include <fstream>
#include <string>

/// CPU and wall seconds since it was made.
class Cost {
 public:
  void write(const std::string& path) const {
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start_;
    std::ofstream(path) << "{\"cpu\": " << cpu_now() - cpu_ << ", \"wall\": " << wall.count() << "}\n";
  }

 private:
  static double cpu_now() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& t) {
      return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
  }

  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  double cpu_ = cpu_now();
};
