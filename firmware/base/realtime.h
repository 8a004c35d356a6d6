#pragma once

#include <cstdint>
#include <string>

namespace sidestep {

/// The clocks and the real-time services of the operating system. No other file of the firmware uses them.

/// Seconds on the monotonic clock.
double monotonic_s();

/// Seconds since 1970; jumps when the system time is set. For time stamps only.
double wall_s();

/// The present date and time in UTC, such as 20260131T235959.000001, for file names.
std::string utc_stamp();

/// CPU time that this thread has used, s.
double thread_cpu_s();

/// Sleeps until an instant of the monotonic clock, s. Returns early when a signal is delivered.
void sleep_until(double instant_s);

/// Locks all present and future memory and touches 512 KiB of the stack, so that the loop never waits for a page fault.
/// If the system does not permit it, or the limit leaves less than 128 MiB for later allocations: returns false and
/// sets `why_not`.
bool lock_memory(std::string& why_not);

/// Puts the calling thread under the normal scheduler. A new thread inherits the scheduler of the thread that starts
/// it, and a process that of its parent.
void use_normal_scheduler();

/// Puts the calling thread under the FIFO scheduler with a priority of 1 (low) to 99. If the system does not permit it:
/// returns false and sets `why_not`.
bool use_fifo(int priority, std::string& why_not);

}  // namespace sidestep
