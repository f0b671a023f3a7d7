#include "csrbf/io/files/discard_bytes.hpp"

#include <gtest/gtest.h>

namespace csrbf::discard_bytes_test {
namespace {

constexpr std::size_t first = 100'001, last = 900'007, size = 1'000'000;

TEST(DiscardBytes, KeepsWhatIsOutside) {
  std::string bytes(size, 'x');
  discard_bytes(bytes.data() + first, bytes.data() + last);
  EXPECT_EQ(bytes.substr(0, first), std::string(first, 'x'));
  EXPECT_EQ(bytes.substr(last), std::string(size - last, 'x'));
  bytes.assign(size, 'y');
  EXPECT_EQ(bytes, std::string(size, 'y')) << "the memory can be used again";
}

TEST(DiscardBytes, TakesRangesOfLessThanAPage) {
  std::string bytes(size, 'x');
  discard_bytes(bytes.data() + first, bytes.data() + first);
  discard_bytes(bytes.data() + first, bytes.data() + first + 1);
  EXPECT_EQ(bytes, std::string(size, 'x'));
}

#ifdef __linux__
// Pages that were given back are zero when they are read again.
TEST(DiscardBytes, GivesPagesBack) {
  std::string bytes(size, 'x');
  discard_bytes(bytes.data() + first, bytes.data() + last);
  EXPECT_EQ(bytes[(first + last) / 2], '\0');
}
#endif

}  // namespace
}  // namespace csrbf::discard_bytes_test
