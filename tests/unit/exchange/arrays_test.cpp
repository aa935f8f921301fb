#include "measure/exchange/arrays.h"

#include <gnomon/error.h>
#include <gtest/gtest.h>

#include <cstring>

#include "measure/scene/blob.h"
#include "measure/scratch_folder.h"

namespace arrays_test {
using namespace gnomon;

// NPY 1.0: magic, version, the length of a dictionary that ends with a line at a multiple of 64, then the numbers.
TEST(Arrays, are_npy_files_of_their_parts) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon-arrays");
  const std::vector<float> x = {1, 2}, y = {3, 4};
  const Json entry = write_array(folder.path() / "a.npy", array_of<float>({2, 1, 2}, {x, y}));
  EXPECT_EQ(entry["type"], "float32");
  EXPECT_EQ(entry["offset"], array_offset);
  EXPECT_EQ(entry["shape"], Json({2, 1, 2}));
  const auto file = MappedFile::open(folder.path() / "a.npy");
  ASSERT_EQ(file->bytes().size(), array_offset + 16);
  const std::string header(reinterpret_cast<const char*>(file->bytes().data()), array_offset);
  EXPECT_EQ(header.substr(0, 10), std::string("\x93NUMPY\x01\x00\x76\x00", 10));
  EXPECT_EQ(header.substr(10, 63), "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 1, 2, )} ");
  EXPECT_EQ(header.back(), '\n');
  float last = 0;
  std::memcpy(&last, file->bytes().data() + array_offset + 12, 4);
  EXPECT_EQ(last, 4);
}

TEST(Arrays, refuse_parts_that_do_not_fill_the_shape_and_folders_that_are_not_there) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon-arrays");
  const std::vector<std::uint32_t> three = {1, 2, 3};
  EXPECT_THROW(write_array(folder.path() / "a.npy", array_of<std::uint32_t>({2, 2}, {three})), Error);
  EXPECT_THROW(write_array(folder.path() / "no/a.npy", array_of<std::uint32_t>({3}, {three})), Error);
}

TEST(Arrays, have_another_hash_where_a_number_or_the_shape_is_another_one) {
  const std::vector<float> a = {1, 2, 3, 4}, b = {1, 2, 3, 5};
  const auto hash = [](const std::vector<float>& numbers, std::vector<std::size_t> shape) {
    return hash_of(array_of<float>(std::move(shape), {numbers}));
  };
  EXPECT_EQ(hash(a, {2, 2}), hash(a, {2, 2}));
  EXPECT_NE(hash(a, {2, 2}), hash(b, {2, 2}));
  EXPECT_NE(hash(a, {2, 2}), hash(a, {4}));
}

}  // namespace arrays_test
