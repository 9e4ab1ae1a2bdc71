// For builds with the address sanitizer. What a driver still holds when it is unloaded could no longer be
// reached and would count as leaked, whichever drivers and layers are installed: so nothing is unloaded. The
// validation layer itself forgets what it had.
extern "C" int dlclose(void*) noexcept { return 0; }
extern "C" const char* __lsan_default_suppressions() { return "leak:libVkLayer_khronos_validation"; }
