"""From programs to machine code: tape, LLVM IR with lanes, cache, listing."""
