#include "firmware/io/lcm/fragment_assembly.h"

#include <algorithm>
#include <cstring>

#include "firmware/io/lcm/message_bytes.h"

namespace sidestep {
namespace {

// The headers, big-endian. Short: magic, sequence number; then channel name, 0, data. Fragment: magic, sequence number,
// size of the message, offset in it (4 bytes each), number of the fragment, number of fragments (2 bytes each); then
// data, after channel name and 0 in the first fragment.
constexpr uint64_t kShortMagic = 0x4c433032, kFragmentMagic = 0x4c433033;  // "LC02", "LC03"
constexpr size_t kShortHeaderBytes = 8, kFragmentHeaderBytes = 20;

uint32_t word(Packet datagram, size_t at) {
  return static_cast<uint32_t>(big_endian(datagram.bytes + at, 4));
}
uint32_t half_word(Packet datagram, size_t at) {
  return static_cast<uint32_t>(big_endian(datagram.bytes + at, 2));
}

Packet without(Packet packet, size_t bytes) {
  return {packet.bytes + bytes, packet.size - bytes};
}

}  // namespace

FragmentAssembly::FragmentAssembly(size_t largest_bytes) : slots_(kSlots), largest_bytes_(largest_bytes) {
  for (Slot& slot : slots_) {
    slot.bytes.resize(largest_bytes);
    slot.pieces.resize(kMostFragments);
  }
}

int FragmentAssembly::subscribe(const std::string& channel) {
  channels_.push_back(channel);
  return static_cast<int>(channels_.size()) - 1;
}

std::optional<FragmentAssembly::Message> FragmentAssembly::malformed() {
  ++malformed_;
  return {};
}

std::optional<FragmentAssembly::Message> FragmentAssembly::add(const Sender& sender, Packet datagram) {
  if (datagram.size < kShortHeaderBytes) return malformed();
  const uint32_t magic = word(datagram, 0);
  if (magic == kShortMagic) return add_short(without(datagram, kShortHeaderBytes));
  if (magic != kFragmentMagic || datagram.size <= kFragmentHeaderBytes) return malformed();

  const Fragment fragment{word(datagram, 4),       word(datagram, 8),       word(datagram, 12),
                          half_word(datagram, 16), half_word(datagram, 18), without(datagram, kFragmentHeaderBytes)};
  if (fragment.number >= fragment.count) return malformed();
  if (fragment.number == 0) return add_first(sender, fragment);
  Slot* slot = find(sender, fragment.sequence);
  return slot ? store(*slot, fragment) : std::nullopt;  // none: of another channel, or its first fragment was lost
}

std::optional<FragmentAssembly::Message> FragmentAssembly::add_short(Packet body) {
  const std::optional<int> channel = take_channel(body);
  if (!channel) return malformed();
  if (*channel < 0) return {};
  return Message{*channel, body, false};
}

std::optional<FragmentAssembly::Message> FragmentAssembly::add_first(const Sender& sender, Fragment fragment) {
  const std::optional<int> channel = take_channel(fragment.data);
  const bool fits = fragment.offset == 0 && fragment.data.size > 0 && fragment.data.size <= fragment.message_bytes;
  if (!channel || !fits) return malformed();
  if (*channel < 0) return {};
  if (fragment.message_bytes > largest_bytes_) return Message{*channel, fragment.data, true};
  if (fragment.count > kMostFragments) return malformed();

  Slot* slot = find(sender, fragment.sequence);
  if (slot) {
    const Piece& first = slot->pieces[0];
    const bool repeated = slot->message_bytes == fragment.message_bytes && slot->count == fragment.count &&
                          slot->channel == *channel && first.end == fragment.data.size &&
                          std::memcmp(slot->bytes.data(), fragment.data.bytes, fragment.data.size) == 0;
    if (repeated) return {};
    ++incomplete_;  // a restarted sender uses its sequence numbers again
  } else {
    slot = &slot_for(sender);
  }
  slot->used = true;
  slot->sender = sender;
  slot->sequence = fragment.sequence;
  slot->message_bytes = fragment.message_bytes;
  slot->count = slot->missing = fragment.count;
  slot->channel = *channel;
  std::fill_n(slot->pieces.begin(), fragment.count, Piece{});
  return store(*slot, fragment);
}

std::optional<FragmentAssembly::Message> FragmentAssembly::store(Slot& slot, const Fragment& fragment) {
  // In 64 bits: in 32 the sum can wrap.
  const Piece piece{fragment.offset, uint64_t{fragment.offset} + fragment.data.size};
  const bool fits = fragment.message_bytes == slot.message_bytes && fragment.count == slot.count &&
                    fragment.data.size > 0 && piece.end <= slot.message_bytes;
  if (!fits) return malformed();
  Piece& stored = slot.pieces[fragment.number];
  if (stored.end > 0) return {};  // repeated
  stored = piece;
  std::memcpy(slot.bytes.data() + piece.begin, fragment.data.bytes, fragment.data.size);
  slot.touched = ++clock_;
  if (--slot.missing > 0) return {};

  slot.used = false;
  if (!is_gapless(slot)) {
    ++incomplete_;
    return {};
  }
  return Message{slot.channel, {slot.bytes.data(), slot.message_bytes}, false};
}

bool FragmentAssembly::is_gapless(const Slot& slot) {
  uint64_t end = 0;
  for (uint32_t i = 0; i < slot.count; ++i) {
    if (slot.pieces[i].begin != end) return false;
    end = slot.pieces[i].end;
  }
  return end == slot.message_bytes;
}

/// Splits the channel's name off the data. Returns its number, -1 for a channel without subscription; nothing where
/// there is no name.
std::optional<int> FragmentAssembly::take_channel(Packet& data) const {
  const size_t searched = std::min(data.size, kLongestChannelName + 1);
  const uint8_t* end = std::find(data.bytes, data.bytes + searched, uint8_t{0});
  if (end == data.bytes + searched) return {};
  const auto length = static_cast<size_t>(end - data.bytes);
  const auto same = [&](const std::string& channel) {
    return channel.size() == length && std::memcmp(channel.data(), data.bytes, length) == 0;
  };
  const auto found = std::find_if(channels_.begin(), channels_.end(), same);
  data = without(data, length + 1);
  return found == channels_.end() ? -1 : static_cast<int>(found - channels_.begin());
}

FragmentAssembly::Slot* FragmentAssembly::find(const Sender& sender, uint32_t sequence) {
  for (Slot& slot : slots_)
    if (slot.used && slot.sequence == sequence && slot.sender == sender) return &slot;
  return nullptr;
}

/// A free slot, else the one that has waited longest for a fragment: among those of the sender if it has its share.
FragmentAssembly::Slot& FragmentAssembly::slot_for(const Sender& sender) {
  Slot *free = nullptr, *oldest = nullptr, *oldest_of_sender = nullptr;
  int of_sender = 0;
  for (Slot& slot : slots_) {
    if (!slot.used) {
      free = &slot;
      continue;
    }
    if (!oldest || slot.touched < oldest->touched) oldest = &slot;
    if (!(slot.sender == sender)) continue;
    ++of_sender;
    if (!oldest_of_sender || slot.touched < oldest_of_sender->touched) oldest_of_sender = &slot;
  }
  if (of_sender < kSlotsPerSender && free) return *free;
  ++incomplete_;
  return of_sender < kSlotsPerSender ? *oldest : *oldest_of_sender;
}

}  // namespace sidestep
