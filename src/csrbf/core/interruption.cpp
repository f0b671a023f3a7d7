#include "csrbf/core/interruption.hpp"

#include "csrbf/core/error.hpp"

#include <utility>

namespace csrbf {
namespace {

thread_local const Interruptible* innermost = nullptr;

}  // namespace

Interruptible::Interruptible(std::function<bool()> interrupted)
    : interrupted_(std::move(interrupted)), outer_(std::exchange(innermost, this)) {}

Interruptible::~Interruptible() {
  innermost = outer_;
}

void stop_if_interrupted() {
  if (innermost != nullptr && innermost->interrupted_()) throw Cancelled();
}

}  // namespace csrbf
