#include "csrbf/io/images/dicom_structure.hpp"

#include "csrbf/io/files/bytes.hpp"

#include <gtest/gtest.h>

namespace csrbf::dicom::dicom_structure_test {
namespace {

std::string tag(std::uint16_t group, std::uint16_t element) {
  std::string bytes;
  append_scalar(bytes, group);
  append_scalar(bytes, element);
  return bytes;
}

std::string with_length(std::string header, std::uint32_t length) {
  append_scalar(header, length);
  return header;
}

std::string short_element(const std::string& header, const std::string& type, const std::string& value) {
  std::string bytes = header + type;
  append_scalar(bytes, static_cast<std::uint16_t>(value.size()));
  return bytes + value;
}

std::string long_element(const std::string& header, const std::string& type, std::uint32_t length) {
  return with_length(header + type + std::string(2, '\0'), length);
}

constexpr std::uint32_t undefined = 0xffffffff;

// A file of the elements, in a transfer syntax.
std::string file(const std::string& elements, std::string syntax = "1.2.840.10008.1.2.1") {
  if (syntax.size() % 2 != 0) syntax += '\0';
  const std::string meta = short_element(tag(2, 0x10), "UI", syntax);
  std::string size;
  append_scalar(size, static_cast<std::uint32_t>(meta.size()));
  return std::string(128, '\0') + "DICM" + short_element(tag(2, 0), "UL", size) + meta + elements;
}

const std::string patient = short_element(tag(0x10, 0x10), "PN", "Nobody");
const std::string pixels = long_element(tag(0x7fe0, 0x10), "OW", 6) + "pixels";
const std::string item_end = with_length(tag(0xfffe, 0xe00d), 0), sequence_end = with_length(tag(0xfffe, 0xe0dd), 0);

std::string item(const std::string& content) {
  return with_length(tag(0xfffe, 0xe000), static_cast<std::uint32_t>(content.size())) + content;
}

std::string open_item(const std::string& content) {
  return with_length(tag(0xfffe, 0xe000), undefined) + content + item_end;
}

std::string sequence(const std::string& items, const std::string& type = "SQ") {
  return long_element(tag(0x40, 0x275), type, undefined) + items + sequence_end;
}

std::string implicit_element(const std::string& header, const std::string& value) {
  return with_length(header, static_cast<std::uint32_t>(value.size())) + value;
}

TEST(DicomStructure, IsWholeWithAllItsElements) {
  EXPECT_TRUE(is_whole(file("")));
  EXPECT_TRUE(is_whole(file(patient + pixels)));
  EXPECT_TRUE(is_whole(file(sequence("") + pixels)));
  EXPECT_TRUE(is_whole(file(sequence(item(patient) + open_item(patient + sequence(item("")))) + pixels)));
  EXPECT_TRUE(is_whole(file(long_element(tag(0x7fe0, 0x10), "OB", undefined) + item("") + item("jpeg") + sequence_end)))
      << "compressed pixels";
}

TEST(DicomStructure, HasElementsWithoutTypes) {
  const std::string name = implicit_element(tag(0x10, 0x10), "Nobody");
  const std::string open = with_length(tag(0x40, 0x275), undefined) + item(name) + open_item(name) + sequence_end;
  EXPECT_TRUE(is_whole(file(name + open, "1.2.840.10008.1.2")));
  EXPECT_FALSE(is_whole(file(name + open)));
  EXPECT_TRUE(is_whole(file(sequence(item(name), "UN")))) << "sequences of unknown type have none";
  EXPECT_FALSE(is_whole(file(sequence(item(name)))));
}

TEST(DicomStructure, IsNotWholeWhereverItEndsTooEarly) {
  const std::string bytes = file(patient + sequence(item(patient) + open_item(patient)) + pixels);
  ASSERT_TRUE(is_whole(bytes));
  const std::size_t first = file("").size(), second = first + patient.size(), third = bytes.size() - pixels.size();
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_EQ(is_whole(bytes.substr(0, size)), size == first || size == second || size == third)
        << size << ": only between elements";
}

TEST(DicomStructure, KnowsTheTypesOfElements) {
  EXPECT_FALSE(is_whole(file(short_element(tag(0x10, 0x10), "XX", "Nobody"))));
  EXPECT_FALSE(is_whole(file(short_element(tag(0x10, 0x10), "E ", "Nobody"))));
  EXPECT_FALSE(is_whole(file(item_end))) << "of no item";
  EXPECT_FALSE(is_whole(file(sequence(patient)))) << "a sequence of no items";
}

TEST(DicomStructure, SurvivesSequencesOfAnyDepth) {
  std::string nested;
  for (int i = 0; i < 10; ++i) nested = sequence(open_item(nested));
  EXPECT_TRUE(is_whole(file(nested)));
  std::string bottomless;
  for (int i = 0; i < 100000; ++i)
    bottomless += long_element(tag(0x40, 0x275), "SQ", undefined) + with_length(tag(0xfffe, 0xe000), undefined);
  EXPECT_FALSE(is_whole(file(bottomless)));
}

TEST(DicomStructure, LooksNoFurtherThanTheHeaderInOtherTransferSyntaxes) {
  EXPECT_TRUE(is_whole(file("deflated", "1.2.840.10008.1.2.1.99")));
  EXPECT_TRUE(is_whole(file("big endian", "1.2.840.10008.1.2.2")));
  EXPECT_FALSE(is_whole(std::string(128, '\0') + "DICM"));
  EXPECT_FALSE(has_preamble(std::string(127, '\0') + "DICM..."));
}

}  // namespace
}  // namespace csrbf::dicom::dicom_structure_test
