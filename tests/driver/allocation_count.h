#pragma once
#include <cstddef>

/// How often this thread has called operator new. Link allocation_count.cpp, which replaces it for the whole
/// test.
std::size_t allocations_of_this_thread();
