#include "abbe/accel/brute/kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "abbe/accel/brute/kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "abbe/accel/leaf/triangles-inl.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

template <class Search>
HWY_INLINE void TestBlocks(std::span<const BlockLine> blocks, const ShearedRay& ray,
                           Search& search) {
  BlockResult result;
  for (std::size_t line = 0; line < blocks.size(); line += kLooseBlockLines) {
    const TriangleBlock& block = block_at(&blocks[line]);
    TestBlockOf<true>(block, ray, search.end(), result);
    if (result.candidates != 0) ShowCandidates(block, result, search);
    if (search.is_done()) return;
  }
}

void TestNearest(std::span<const BlockLine> blocks, const ShearedRay& ray, NearestSearch& search) {
  TestBlocks(blocks, ray, search);
}

void TestAll(std::span<const BlockLine> blocks, const ShearedRay& ray, AllSearch& search) {
  TestBlocks(blocks, ray, search);
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace abbe {

HWY_EXPORT(TestNearest);
HWY_EXPORT(TestAll);

void test_blocks(std::span<const BlockLine> blocks, const ShearedRay& ray, NearestSearch& search) {
  HWY_DYNAMIC_DISPATCH(TestNearest)(blocks, ray, search);
}

void test_blocks(std::span<const BlockLine> blocks, const ShearedRay& ray, AllSearch& search) {
  HWY_DYNAMIC_DISPATCH(TestAll)(blocks, ray, search);
}

}  // namespace abbe
#endif
