#pragma once

#include <bit>
#include <type_traits>

namespace csrbf {

#ifdef __cpp_lib_bit_cast
using std::bit_cast;
#else
/// std::bit_cast, which libc++ has since version 14.
template <class To, class From>
constexpr To bit_cast(const From& from) noexcept {
  static_assert(sizeof(To) == sizeof(From) && std::is_trivially_copyable_v<To> && std::is_trivially_copyable_v<From>);
  return __builtin_bit_cast(To, from);
}
#endif

}  // namespace csrbf
