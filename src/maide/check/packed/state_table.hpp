// A lossless hash set of packed states that stores only a part of each: the place in the table
// tells the rest (quotienting: Cleary, "Compact hash tables using bidirectional linear probing",
// IEEE ToC 1984; for state spaces Geldenhuys & Valmari, "A nearly memory-optimal data structure for
// sets and mappings", SPIN 2003). Each state carries a payload, a few bits of its owner's choice.
//
// A bijection scrambles the first word of a state. The result, read as a fraction, times the number
// of slots is the state's home. An entry lies at its home or a few slots behind it, and entries lie
// in the order of their homes. An entry holds how far behind its home it lies, the payload, and as
// many low bits of the scrambled word as tell apart the words of one home.
//
// Thanks to that the table may have any number of slots, entries become smaller as it grows, and
// growing reads and writes in order. Sixteen segments grow one at a time, so memory never doubles.
// A lookup costs one cache miss as a rule. Threads may work on different segments at once.
#pragma once

#include <sys/mman.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <new>
#include <vector>

#include "maide/base/hash.hpp"
#include "maide/base/invariant.hpp"
#include "maide/base/numbers.hpp"

namespace maide {

// A product of two numbers of 64 bits; a language extension of g++ and clang.
__extension__ using WideNumber = unsigned __int128;

// A state of `words` 64-bit words.
template <std::size_t words>
using PackedState = std::array<std::uint64_t, words>;

// States of more words than these are kept in one kind, of which each system uses the first few;
// a table stores no others.
inline constexpr std::size_t most_own_words = 8;

// An invertible scrambling of the numbers below 2^bits, 24 <= bits <= 64.
class Scrambler {
 public:
  explicit Scrambler(unsigned bits) : mask_(low_bits(bits)), shift_((bits + 1) / 2) {}

  std::uint64_t apply(std::uint64_t x) const {
    x = (x * factor) & mask_;
    x ^= x >> shift_;
    x = (x * factor) & mask_;
    x ^= x >> shift_;
    return (x * factor) & mask_;
  }
  std::uint64_t invert(std::uint64_t x) const {
    // Half of the bits shifted away: the same step undoes itself.
    x = (x * inverse) & mask_;
    x ^= x >> shift_;
    x = (x * inverse) & mask_;
    x ^= x >> shift_;
    return (x * inverse) & mask_;
  }

 private:
  // 2^64 divided by the golden ratio, made odd; and its inverse modulo 2^64.
  static constexpr std::uint64_t factor = 0x9e3779b97f4a7c15ULL;
  static constexpr std::uint64_t inverse = 0xf1de83e19937733dULL;
  static_assert(factor * inverse == 1);
  std::uint64_t mask_;
  unsigned shift_;
};

// Most bits of a state of one word and what is stored with it, in a table.
inline constexpr unsigned most_bits_together = 76;

template <std::size_t words>
class StateTable {
 public:
  using State = PackedState<words>;

  // `address_bits` of a state's first word are used; 0..64. `payload_bits`: 0..32. With one word
  // both together are at most most_bits_together, with more the first word has at most 44.
  // `used_words`: those that are not always 0, which matters for more than most_own_words.
  StateTable(unsigned address_bits, unsigned payload_bits, std::size_t used_words = words)
      : bits_(std::max(address_bits, 24U)),
        payload_bits_(payload_bits),
        used_words_(used_words),
        scrambler_(bits_) {
    MAIDE_CHECK(used_words_ <= words);
    const unsigned local = bits_ - segment_bits;
    unsigned slot_bits = 6;
    while (8 + payload_bits_ + local > 64 + slot_bits) ++slot_bits;
    for (Segment& segment : segments_) allocate(segment, std::uint64_t{1} << slot_bits);
  }
  StateTable(const StateTable&) = delete;
  StateTable& operator=(const StateTable&) = delete;
  ~StateTable() {
    for (Segment& segment : segments_) unmap(segment);
  }

  struct Insertion {
    bool is_new = false;
    std::uint64_t payload = 0;  // that of the state in the table
  };
  // Where a state lies: computed once, ahead of its use.
  struct Address {
    std::uint64_t scrambled = 0;
  };
  static constexpr unsigned segment_bits = 4;
  static constexpr std::size_t segment_count = std::size_t{1} << segment_bits;

  Address address_of(const State& state) const {
    std::uint64_t first = state[0];
    MAIDE_CHECK(first <= mask());
    if constexpr (words > 1) first ^= fold(state) & mask();
    return {scrambler_.apply(first)};
  }
  std::size_t segment_of(const Address& address) const {
    return address.scrambled >> (bits_ - segment_bits);
  }
  // Inlined, for g++ 12 takes a call of a function that only fetches ahead for one of no use.
  [[gnu::always_inline]] void prefetch(const Address& address) const {
    const Segment& segment = segments_[segment_of(address)];
    __builtin_prefetch(segment.data + home(segment, local_of(address)) * segment.width);
  }

  // Adds the state with `payload` if it is not there. Throws std::bad_alloc.
  Insertion insert(const State& state, const Address& address, std::uint64_t payload) {
    MAIDE_CHECK(payload <= payload_mask());
    Segment& segment = segments_[segment_of(address)];
    const std::uint64_t local = local_of(address);
    if (is_full(segment, 1)) grow(segment);
    while (true) {
      const Place place = locate(segment, local, state);
      if (place.is_there) {
        return {false, (load(segment, place.at) >> 8) & payload_mask()};
      }
      if (make_room(segment, place.at, place.home)) {
        MAIDE_CHECK(place.home < segment.slots && place.at < segment.slots + most_distance);
        const std::uint64_t residual = local & segment.residual_mask;
        store(segment, place.at,
              (place.at - place.home + 1) | (payload << 8) | (residual << residual_shift()), state);
        ++segment.size;
        return {true, payload};
      }
      grow(segment);
    }
  }
  Insertion insert(const State& state, std::uint64_t payload) {
    return insert(state, address_of(state), payload);
  }

  // Segments fill evenly. So that threads grow theirs at the same time, and not one after another,
  // they call grow_if_near() of each as soon as one is_due(): it grows before so many more states
  // are in it.
  bool is_due(std::uint64_t states) const {
    return std::ranges::any_of(segments_,
                               [&](const Segment& segment) { return is_full(segment, states); });
  }
  void grow_if_near(std::size_t segment) {
    if (is_full(segments_[segment], segments_[segment].slots / 32)) grow(segments_[segment]);
  }

  // The state's payload; false if it is not there.
  bool find(const State& state, std::uint64_t& payload) const {
    return find(state, address_of(state), payload);
  }
  bool find(const State& state, const Address& address, std::uint64_t& payload) const {
    const Segment& segment = segments_[segment_of(address)];
    const Place place = locate(segment, local_of(address), state);
    if (place.is_there) payload = (load(segment, place.at) >> 8) & payload_mask();
    return place.is_there;
  }

  // Calls `visit(state, payload)` for each state, in no order that means anything.
  template <typename Visit>
  void for_each(Visit&& visit) const {
    const unsigned local = bits_ - segment_bits;
    for (std::size_t number = 0; number < segment_count; ++number) {
      const Segment& segment = segments_[number];
      for_each_local(segment, [&](std::uint64_t at, std::uint64_t entry, std::uint64_t value) {
        State state = rest_at(segment, at);
        state[0] = scrambler_.invert(value | (std::uint64_t{number} << local));
        if constexpr (words > 1) state[0] ^= fold(state) & mask();
        visit(state, (entry >> 8) & payload_mask());
      });
    }
  }

  // Throws std::logic_error unless every entry lies at its home or behind it, without an empty slot
  // between, in the order of homes, and is found there. O(slots).
  void check_invariants() const {
    std::uint64_t bytes = 0;
    for (const Segment& segment : segments_) {
      std::uint64_t entries = 0, last_home = 0, empty = 0;  // slots before `empty` may be free
      for_each_local(segment, [&](std::uint64_t at, std::uint64_t entry, std::uint64_t value) {
        const std::uint64_t own_home = home(segment, value);
        MAIDE_CHECK_ALWAYS(at - own_home + 1 == (entry & 255) && own_home >= last_home);
        for (std::uint64_t slot = std::max(own_home, empty); slot < at; ++slot) {
          MAIDE_CHECK_ALWAYS(distance_at(segment, slot) != 0);
        }
        const Place place = locate(segment, value, rest_at(segment, at));
        MAIDE_CHECK_ALWAYS(place.is_there && place.at == at);
        last_home = own_home;
        empty = at + 1;
        ++entries;
      });
      MAIDE_CHECK_ALWAYS(entries == segment.size && segment.size <= segment.slots);
      bytes += segment.bytes;
    }
    MAIDE_CHECK_ALWAYS(bytes == bytes_ && bytes_ <= peak_bytes_);
  }

  // O(segments).
  std::uint64_t size() const {
    std::uint64_t sum = 0;
    for (const Segment& segment : segments_) sum += segment.size;
    return sum;
  }
  std::uint64_t bytes() const { return bytes_; }
  // The most that it ever had, while growing.
  std::uint64_t peak_bytes() const { return peak_bytes_; }
  // What it would take to grow once more, about.
  std::uint64_t growth_bytes() const { return 2 * bytes_ / segment_count; }

 private:
  static constexpr std::uint64_t most_distance = 255;  // of an entry behind its home, plus 1
  // Of what is stored of a state besides its first word.
  std::size_t rest_bytes() const {
    if constexpr (words > most_own_words) return 8 * (used_words_ - 1);
    return 8 * (words - 1);
  }

  // In a cache line of its own, since each may be another thread's.
  struct alignas(64) Segment {
    unsigned char* data = nullptr;
    std::uint64_t slots = 0;  // homes; `most_distance` more lie behind the last
    std::uint64_t size = 0;
    std::uint64_t residual_mask = 0;
    std::uint64_t low_mask = 0;  // of an entry's first bytes
    unsigned low_bytes = 0;
    unsigned width = 0;  // bytes of an entry
    std::uint64_t bytes = 0;
  };

  std::uint64_t mask() const { return low_bits(bits_); }
  std::uint64_t local_of(const Address& address) const {
    return address.scrambled & low_bits(bits_ - segment_bits);
  }
  std::uint64_t payload_mask() const { return low_bits(payload_bits_); }
  unsigned residual_shift() const { return 8 + payload_bits_; }

  static bool is_full(const Segment& segment, std::uint64_t more) {
    return (segment.size + more) * 5 > segment.slots * 4;
  }

  std::uint64_t fold(const State& state) const {
    const std::size_t count = words > most_own_words ? used_words_ : words;
    std::uint64_t sum = 0;
    for (std::size_t i = 1; i < count; ++i) sum = hash_mix(sum, state[i]);
    return sum;
  }

  std::uint64_t home(const Segment& segment, std::uint64_t local) const {
    return static_cast<std::uint64_t>((WideNumber{local} * segment.slots) >>
                                      (bits_ - segment_bits));
  }

  std::uint64_t load(const Segment& segment, std::uint64_t at) const {
    std::uint64_t value;
    std::memcpy(&value, segment.data + at * segment.width, sizeof value);
    return value & segment.low_mask;
  }
  bool has_rest(const Segment& segment, std::uint64_t at, const State& state) const {
    if constexpr (words == 1) return true;
    return std::memcmp(segment.data + at * segment.width + segment.low_bytes, &state[0] + 1,
                       rest_bytes()) == 0;
  }
  State rest_at(const Segment& segment, std::uint64_t at) const {
    State state{};
    if constexpr (words > 1) {
      std::memcpy(&state[0] + 1, segment.data + at * segment.width + segment.low_bytes,
                  rest_bytes());
    }
    return state;
  }
  void store(Segment& segment, std::uint64_t at, std::uint64_t entry, const State& state) {
    unsigned char* place = segment.data + at * segment.width;
    // Eight bytes at once; those behind the entry's stay what they are.
    std::uint64_t value;
    std::memcpy(&value, place, sizeof value);
    value = (value & ~segment.low_mask) | (entry & segment.low_mask);
    std::memcpy(place, &value, sizeof value);
    if constexpr (words > 1) std::memcpy(place + segment.low_bytes, &state[0] + 1, rest_bytes());
  }

  struct Place {
    std::uint64_t home = 0;
    std::uint64_t at = 0;  // where the state is, or belongs
    bool is_there = false;
  };
  Place locate(const Segment& segment, std::uint64_t local, const State& state) const {
    Place place{home(segment, local), 0, false};
    const std::uint64_t residual = local & segment.residual_mask;
    for (place.at = place.home;; ++place.at) {
      const std::uint64_t entry = load(segment, place.at);
      const std::uint64_t distance = entry & 255;
      const std::uint64_t own_distance = place.at - place.home + 1;
      if (distance > own_distance) continue;      // of a home before ours
      if (distance < own_distance) return place;  // empty, or of a home behind ours
      if ((entry >> residual_shift()) == residual && has_rest(segment, place.at, state)) {
        place.is_there = true;
        return place;
      }
    }
  }

  // 0: the slot is empty.
  static std::uint64_t distance_at(const Segment& segment, std::uint64_t at) {
    return segment.data[at * segment.width];
  }

  // Moves the entries from `at` on one slot further; false if one would be too far from home.
  bool make_room(Segment& segment, std::uint64_t at, std::uint64_t own_home) {
    MAIDE_CHECK(at >= own_home);
    if (at - own_home + 1 > most_distance) return false;
    std::uint64_t end = at;
    for (std::uint64_t distance; (distance = distance_at(segment, end)) != 0; ++end) {
      if (distance == most_distance) return false;
    }
    if (end >= segment.slots + most_distance) return false;
    unsigned char* first = segment.data + at * segment.width;
    std::memmove(first + segment.width, first, (end - at) * segment.width);
    for (std::uint64_t moved = at + 1; moved <= end; ++moved) ++segment.data[moved * segment.width];
    return true;
  }

  // The least local number of each home, without a division: range / slots = whole + part / 2^64,
  // nearly; what that misses is at most one, and shows in the rest.
  class FirstOfHome {
   public:
    FirstOfHome(WideNumber range, std::uint64_t slots)
        : slots_(slots),
          whole_(static_cast<std::uint64_t>(range / slots)),
          rest_(static_cast<std::uint64_t>(range % slots)),
          part_(static_cast<std::uint64_t>((WideNumber{rest_} << 64) / slots)) {}
    std::uint64_t operator()(std::uint64_t own_home) const {
      const auto parts = static_cast<std::uint64_t>((WideNumber{part_} * own_home) >> 64);
      const std::uint64_t rest = own_home * rest_ - parts * slots_;  // 0 .. 2 slots - 1
      const std::uint64_t floor = own_home * whole_ + parts;
      // Rounded up: one more if anything is left, and one for the slots that were missed.
      return floor + (rest > 0 ? 1 : 0) + (rest > slots_ ? 1 : 0);
    }

   private:
    std::uint64_t slots_, whole_, rest_, part_;
  };

  // Calls `visit(at, entry, local)` for each entry, by home.
  template <typename Visit>
  void for_each_local(const Segment& segment, Visit&& visit) const {
    const FirstOfHome first_of(WideNumber{1} << (bits_ - segment_bits), segment.slots);
    for (std::uint64_t at = 0; at < segment.slots + most_distance; ++at) {
      const std::uint64_t entry = load(segment, at);
      const std::uint64_t distance = entry & 255;
      if (distance == 0) continue;
      const std::uint64_t first = first_of(at - (distance - 1));
      const std::uint64_t residual = entry >> residual_shift();
      visit(at, entry, first + ((residual - first) & segment.residual_mask));
    }
  }

  static constexpr std::uint64_t huge_page = std::uint64_t{1} << 21;
  // Large ones are pages of their own: zero, and given back at once.
  static bool is_mapped(std::uint64_t bytes) { return bytes >= 2 * huge_page; }
  static std::uint64_t mapped_bytes(std::uint64_t bytes) {
    return is_mapped(bytes) ? (bytes + huge_page - 1) / huge_page * huge_page : bytes;
  }
  static unsigned char* map_zeros(std::uint64_t bytes) {
    if (!is_mapped(bytes)) {
      void* data = std::calloc(bytes, 1);
      if (data == nullptr) throw std::bad_alloc();
      return static_cast<unsigned char*>(data);
    }
    // One huge page more, and what is not on their bounds is given back.
    void* mapped = ::mmap(nullptr, bytes + huge_page, PROT_READ | PROT_WRITE,
                          MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (mapped == MAP_FAILED) throw std::bad_alloc();
    auto* const start = static_cast<unsigned char*>(mapped);
    const std::uint64_t before = -reinterpret_cast<std::uintptr_t>(start) % huge_page;
    if (before > 0) ::munmap(start, before);
    if (before < huge_page) ::munmap(start + before + bytes, huge_page - before);
    ::madvise(start + before, bytes, MADV_HUGEPAGE);
    return start + before;
  }
  // Writes to each page. A page that is read first is mapped twice, and the second time stops all
  // threads.
  static void touch(const Segment& segment) {
    constexpr std::uint64_t page = 4096;
    volatile unsigned char* const data = segment.data;
    for (std::uint64_t at = 0; at < segment.bytes; at += page) data[at] = 0;
  }
  static void unmap(const Segment& segment) {
    if (is_mapped(segment.bytes)) {
      ::munmap(segment.data, segment.bytes);
    } else {
      std::free(segment.data);
    }
  }

  void allocate(Segment& segment, std::uint64_t slots) {
    const unsigned local = bits_ - segment_bits;
    const WideNumber range = WideNumber{1} << local;
    const auto span = static_cast<std::uint64_t>((range + slots - 1) / slots);
    const auto residual_bits = static_cast<unsigned>(std::bit_width(span - 1));
    segment.slots = slots;
    segment.residual_mask = low_bits(residual_bits);
    const unsigned used_bits = 8 + payload_bits_ + residual_bits;
    segment.low_bytes = (used_bits + 7) / 8;
    segment.low_mask = low_bits(8 * segment.low_bytes);
    segment.width = segment.low_bytes + static_cast<unsigned>(rest_bytes());
    // Entries are read eight bytes at a time, the last one too.
    segment.bytes = mapped_bytes((slots + most_distance + 1) * segment.width + 8);
    segment.data = map_zeros(segment.bytes);
    touch(segment);
    const std::uint64_t bytes = bytes_ += segment.bytes;
    std::uint64_t peak = peak_bytes_;
    while (peak < bytes && !peak_bytes_.compare_exchange_weak(peak, bytes)) {
    }
  }

  void release(const Segment& segment) {
    unmap(segment);
    bytes_ -= segment.bytes;
  }

  // Throws std::bad_alloc, and then the segment is what it was.
  void grow(Segment& segment) {
    for (std::uint64_t slots = segment.slots + segment.slots * 2 / 5 + 8;; slots += slots / 4) {
      Segment larger;
      allocate(larger, slots);
      MAIDE_CHECK(larger.slots > segment.slots && larger.low_bytes <= 8);
      if (copy(segment, larger)) {
        release(segment);
        segment = larger;
        return;
      }
      release(larger);
    }
  }

  // In the order of homes, but those of one home are in none: where they part, some come late.
  // False if one would come too far from home.
  bool copy(const Segment& from, Segment& to) {
    std::uint64_t next = 0;  // the first slot behind all entries
    std::uint64_t last_home = 0;
    bool fits = true;
    for_each_local(from, [&](std::uint64_t place, std::uint64_t entry, std::uint64_t value) {
      const std::uint64_t new_home = home(to, value);
      std::uint64_t at = std::max(next, new_home);
      if (new_home < last_home) {
        at = new_home;
        while (distance_at(to, at) > at - new_home) ++at;
        fits = fits && make_room(to, at, new_home);
        while (distance_at(to, next) != 0) ++next;
      } else {
        last_home = new_home;
        next = at + 1;
      }
      fits = fits && at - new_home < most_distance;
      if (!fits) return;
      const std::uint64_t payload = entry & (payload_mask() << 8);
      const std::uint64_t residual = value & to.residual_mask;
      store(to, at, (at - new_home + 1) | payload | (residual << residual_shift()),
            rest_at(from, place));
    });
    to.size = from.size;
    return fits;
  }

  unsigned bits_, payload_bits_;
  std::size_t used_words_;
  Scrambler scrambler_;
  std::vector<Segment> segments_{segment_count};
  std::atomic<std::uint64_t> bytes_ = 0, peak_bytes_ = 0;
};

}  // namespace maide
