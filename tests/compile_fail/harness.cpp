// expect: (static assertion failed|static_assert failed).*a law must name its stiffness
// SPDX-License-Identifier: MIT
// Proves the harness and needs nothing of the library.

struct WithStiffness {
  double stiffness;
};
struct WithoutStiffness {};

template <class Law>
void use(Law) {
  static_assert(requires(Law law) { law.stiffness; }, "a law must name its stiffness");
}

int main() {
#ifdef SILT_VALID
  use(WithStiffness{1.0});
#else
  use(WithoutStiffness{});
#endif
}
