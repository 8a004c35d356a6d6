#pragma once

#include <cstdint>
#include <string>

namespace sidestep {

/// The clocks and the real-time services of the machine; the only place besides main that knows them.

/// Seconds on the monotonic clock.
double monotonic_s();

/// Seconds since 1970; may be set back and forth by others.
double wall_s();

/// CPU time that this thread has used, s.
double thread_cpu_s();

/// Sleeps until an instant of the monotonic clock; returns early when a signal comes.
void sleep_until(double instant_s);

/// Locks all memory and touches the stack, so that the loop never waits for a page.
/// Returns false, and why, when the machine does not permit it.
bool lock_memory(std::string& why_not);

/// Puts the calling thread under the FIFO scheduler, 1 (low) to 99. Returns false, and why, when not permitted.
bool use_fifo(int priority, std::string& why_not);

}  // namespace sidestep
