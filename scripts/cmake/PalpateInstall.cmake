# Installation and packaging: `cmake --install` gives the library, `cpack` the bundle.
