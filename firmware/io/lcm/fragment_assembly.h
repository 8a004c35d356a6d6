#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware/io/lcm/packet.h"

namespace sidestep {

/// Where a datagram came from.
struct Sender {
  uint32_t address = 0;
  uint16_t port = 0;

  bool operator==(const Sender& other) const { return address == other.address && port == other.port; }
};

/// The datagrams of LCM's UDP multicast to messages: a short message is one datagram, a longer one several fragments,
/// of which the first names the channel. The datagrams may hold any bytes. All memory is allocated at the start; add()
/// neither allocates nor throws. Large: several megabytes on the heap.
///
/// A message is complete when its fragments follow each other without gap or overlap. Those after the first may arrive
/// in any order. At most kSlots messages are incomplete at a time, at most kSlotsPerSender of one sender; a first
/// fragment beyond that discards the message that has waited longest for a fragment. To discard a message of another
/// sender, kSlots / kSlotsPerSender senders must send between two of its fragments.
class FragmentAssembly {
 public:
  static constexpr int kSlots = 16;
  static constexpr int kSlotsPerSender = 2;          // liblcm sends one after the other; 2 for datagrams out of order
  static constexpr uint32_t kMostFragments = 1024;   // a message of 545 kB in Ethernet frames has 374
  static constexpr size_t kLongestChannelName = 63;  // liblcm's

  /// largest_bytes: of a message.
  explicit FragmentAssembly(size_t largest_bytes);

  /// Messages of other channels are dropped. Returns the number of the channel, from 0.
  int subscribe(const std::string& channel);

  struct Message {
    int channel;    ///< as returned by subscribe()
    Packet packet;  ///< valid until the next add(), while the datagram is
    /// The message is larger than the largest one. Only the data of its first fragment is here, for the receiver to
    /// count and to report; its size is then not what its content implies.
    bool cut;
  };
  /// The message that this datagram completes, if it does.
  std::optional<Message> add(const Sender& sender, Packet datagram);

  int64_t malformed_datagrams() const { return malformed_; }
  int64_t incomplete_messages() const { return incomplete_; }  ///< discarded because a fragment was missing or wrong

 private:
  struct Fragment {
    uint32_t sequence, message_bytes, offset, number, count;
    Packet data;
  };
  struct Piece {
    uint64_t begin = 0, end = 0;  // within the message; end 0: not received
  };
  struct Slot {
    bool used = false;
    Sender sender;
    uint32_t sequence = 0, message_bytes = 0, count = 0, missing = 0;
    int channel = 0;
    uint64_t touched = 0;
    std::vector<uint8_t> bytes;
    std::vector<Piece> pieces;
  };

  std::optional<Message> malformed();
  std::optional<Message> add_short(Packet body);
  std::optional<Message> add_first(const Sender& sender, Fragment fragment);
  std::optional<Message> store(Slot& slot, const Fragment& fragment);
  static bool is_gapless(const Slot& slot);
  std::optional<int> take_channel(Packet& data) const;
  Slot* find(const Sender& sender, uint32_t sequence);
  Slot& slot_for(const Sender& sender);

  std::vector<std::string> channels_;
  std::vector<Slot> slots_;
  size_t largest_bytes_;
  uint64_t clock_ = 0;  // counts stored fragments
  int64_t malformed_ = 0;
  int64_t incomplete_ = 0;
};

}  // namespace sidestep
