#include "maide/automata/partition.hpp"

#include <numeric>

namespace maide {

Partition::Partition(std::size_t elements)
    : elements_(elements), place_(elements), block_of_(elements) {
  std::iota(elements_.begin(), elements_.end(), Element{0});
  std::iota(place_.begin(), place_.end(), std::uint32_t{0});
  if (elements == 0) return;
  begin_.push_back(0);
  end_.push_back(static_cast<std::uint32_t>(elements));
  marked_.push_back(0);
}

Partition::Block Partition::split(Block block) {
  const std::uint32_t count = std::exchange(marked_[block], 0);
  MAIDE_CHECK(count <= size(block));
  if (count == 0 || count == size(block)) return block;
  const Block fresh = blocks();
  begin_.push_back(begin_[block]);
  end_.push_back(begin_[block] + count);
  marked_.push_back(0);
  begin_[block] += count;
  MAIDE_CHECK(size(block) > 0 && size(fresh) == count && end_[fresh] == begin_[block]);
  for (const Element element : elements(fresh)) block_of_[element] = fresh;
  return fresh;
}

Partition::Block Partition::cut(Block block, std::uint32_t place) {
  MAIDE_CHECK(begin_[block] < place && place < end_[block]);
  begin_.push_back(place);
  end_.push_back(std::exchange(end_[block], place));
  marked_.push_back(0);
  return blocks() - 1;
}

void Partition::check_invariants() const {
  MAIDE_CHECK_ALWAYS(end_.size() == blocks() && marked_.size() == blocks());
  MAIDE_CHECK_ALWAYS(place_.size() == elements_.size() && block_of_.size() == elements_.size());
  std::size_t covered = 0;
  for (Block block = 0; block < blocks(); ++block) {
    MAIDE_CHECK_ALWAYS(begin_[block] < end_[block] && end_[block] <= elements_.size());
    MAIDE_CHECK_ALWAYS(marked_[block] <= size(block));
    covered += size(block);
    for (const Element element : elements(block)) {
      MAIDE_CHECK_ALWAYS(element < elements_.size() && elements_[place_[element]] == element);
      MAIDE_CHECK_ALWAYS(block_of_[element] == block);
    }
  }
  MAIDE_CHECK_ALWAYS(covered == elements_.size());
}

}  // namespace maide
