// SPDX-License-Identifier: MIT
// The runtime of exceptions for WebAssembly, which libc++abi of Debian's LLVM 19 is built without.
// To be deleted when libc++abi-NN-dev-wasm32 defines __cxa_throw. It serves one thread.
//
// clang calls _Unwind_CallPersonality at a catch clause with a type, and reads from
// __wasm_lpad_context which clause it is. The names and tables are those of the Itanium C++ ABI for
// exceptions and of LLVM's handling of exceptions for WebAssembly.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <typeinfo>

namespace __cxxabiv1 {
// As in libc++abi's private_typeinfo.h: only the place of can_catch among the virtual functions
// matters.
class __shim_type_info : public std::type_info {
 public:
  ~__shim_type_info() override;
  virtual void noop1() const;
  virtual void noop2() const;
  virtual bool can_catch(const __shim_type_info* thrown, void*& object) const = 0;
};
}  // namespace __cxxabiv1

namespace {

using TypeInfo = __cxxabiv1::__shim_type_info;

// In memory directly before the object that is thrown.
struct alignas(16) Exception {
  const TypeInfo* type;
  void* (*destroy)(void*);  // destructors return this in the ABI of WebAssembly
  void* adjusted;           // the object as the type of the clause that catches it
  int handlers;             // that have begun and not ended; negative while it is thrown again
  Exception* outer;         // the one that was being handled before
};

Exception* caught = nullptr;  // the innermost one that is being handled

Exception* exception_of(void* object) { return static_cast<Exception*>(object) - 1; }

// A number of at most 32 bits, seven bits a byte.
std::uint32_t read_number(const std::uint8_t*& at, bool is_signed) {
  std::uint32_t value = 0;
  unsigned shift = 0;
  std::uint8_t byte;
  do {
    byte = *at++;
    value |= std::uint32_t(byte & 0x7f) << shift;
    shift += 7;
  } while (byte & 0x80);
  if (is_signed && (byte & 0x40) && shift < 32) value |= ~std::uint32_t(0) << shift;
  return value;
}

// Number of the first type among the clauses of a landing pad that catches the exception, and 0 if
// none does.
int find_clause(const std::uint8_t* table, std::uint32_t pad, Exception& exception) {
  const std::uint8_t* at = table + 1;  // the first byte is the omitted start of the landing pads
  constexpr std::uint8_t omitted = 0xff;
  const TypeInfo* const* types = nullptr;
  if (*at++ != omitted) {
    const std::uint32_t offset = read_number(at, false);
    types = reinterpret_cast<const TypeInfo* const*>(at + offset);
  }
  ++at;  // encoding of the landing pads
  const std::uint32_t length = read_number(at, false);
  const std::uint8_t* const actions = at + length;
  std::uint32_t action = 0;
  for (std::uint32_t k = 0; k <= pad && at < actions; ++k) {
    read_number(at, false);
    action = read_number(at, false);
  }
  if (action == 0) return 0;
  const std::uint8_t* next = actions + action - 1;
  while (true) {
    const int number = int(read_number(next, true));
    if (number > 0) {
      const TypeInfo* const type = types[-number];
      void* object = &exception + 1;
      if (type == nullptr || type->can_catch(exception.type, object)) {
        exception.adjusted = object;
        return number;
      }
    }
    const std::uint8_t* const from = next;
    const int offset = int(read_number(next, true));
    if (offset == 0) return 0;
    next = from + offset;
  }
}

}  // namespace

extern "C" {

struct {
  std::uint32_t pad;
  const std::uint8_t* table;
  int clause;
} __wasm_lpad_context;

int _Unwind_CallPersonality(void* exception) {
  __wasm_lpad_context.clause = find_clause(__wasm_lpad_context.table, __wasm_lpad_context.pad,
                                           *static_cast<Exception*>(exception));
  return 0;
}

void* __cxa_allocate_exception(std::size_t size) {
  void* const memory = std::calloc(1, sizeof(Exception) + size);
  if (memory == nullptr) std::abort();
  return static_cast<Exception*>(memory) + 1;
}
void __cxa_free_exception(void* object) { std::free(exception_of(object)); }

[[noreturn]] void __cxa_throw(void* object, void* type, void* (*destroy)(void*)) {
  Exception* const exception = exception_of(object);
  exception->type = static_cast<const TypeInfo*>(type);
  exception->destroy = destroy;
  exception->adjusted = object;
  __builtin_wasm_throw(0, exception);
}

void* __cxa_begin_catch(void* thrown) {
  auto* const exception = static_cast<Exception*>(thrown);
  exception->handlers = (exception->handlers < 0 ? -exception->handlers : exception->handlers) + 1;
  if (caught != exception) {
    exception->outer = caught;
    caught = exception;
  }
  return exception->adjusted;
}

void __cxa_end_catch() {
  Exception* const exception = caught;
  if (exception == nullptr) return;
  const bool is_thrown_again = exception->handlers < 0;
  exception->handlers += is_thrown_again ? 1 : -1;
  if (exception->handlers != 0) return;
  caught = exception->outer;
  if (is_thrown_again) return;
  if (exception->destroy != nullptr) exception->destroy(exception + 1);
  std::free(exception);
}

[[noreturn]] void __cxa_rethrow() {
  if (caught == nullptr) std::abort();
  caught->handlers = -caught->handlers;
  __builtin_wasm_throw(0, caught);
}

}  // extern "C"
