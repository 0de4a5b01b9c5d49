"""The C target: one header and one source in C99 that need nothing but the C library."""
