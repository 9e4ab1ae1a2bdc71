// Nothing but the headers that CMake puts before every file (PalpateTargets.cmake).
