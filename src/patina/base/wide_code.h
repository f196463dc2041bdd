// Loops that are compiled twice: for the registers that all of patina is compiled for, and for
// AVX-512, which is taken where the machine has it. What is computed element by element has the
// same bytes from both, as the compiler neither fuses nor reorders operations.
#pragma once

namespace patina {

// What a loop passed to run_wide() is declared with, behind its parameters:
// [&]() PATINA_WIDE { for ... }
#define PATINA_WIDE __attribute__((always_inline))

// Whether run_wide() takes AVX-512 now.
[[nodiscard]] bool takes_avx512();

// While it lives run_wide() takes the code that all of patina is compiled for; for tests.
class NarrowCode {
  public:
    NarrowCode();
    ~NarrowCode();
    NarrowCode(const NarrowCode&) = delete;
    NarrowCode& operator=(const NarrowCode&) = delete;
};

#if defined(__x86_64__)
template <typename Loop>
[[gnu::target("avx512f,avx512bw,avx512dq,avx512vl"), gnu::noinline]] void run_avx512(
    const Loop& loop) {
    loop();
}
#endif

// Calls loop(), which every function that it calls must allow to be inlined. Several arrays of one
// object may be captured by reference; addresses of different objects by value, or the compiler,
// which cannot tell them apart then, leaves the loop scalar.
template <typename Loop>
void run_wide(const Loop& loop) {
#if defined(__x86_64__)
    if (takes_avx512()) return run_avx512(loop);
#endif
    loop();
}

}  // namespace patina
