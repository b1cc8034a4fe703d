// A library for LD_PRELOAD that makes chosen calls of a program fail. The environment:
//   RIVULET_FAULT_MODULE  the program or library whose calls count: "rivulet", "librivulet.so"
//   RIVULET_FAULT         KIND:N: the N-th call of the kind fails; KIND:N+: and all behind it
//   RIVULET_FAULT_COUNTS  a file of kKinds + 1 numbers of 8 bytes: how many calls of each kind there were, and how many failed
// A program that is loaded with it may choose by faults_arm() what fails.
#include "tests/faults/interposer.h"

#include <fcntl.h>
#include <link.h>
#include <sys/mman.h>
#include <unistd.h>
#include <unwind.h>

#include <atomic>
#include <cstdlib>
#include <cstring>
#include <initializer_list>

extern "C" {
void faults_arm(int kind, long number, int onwards);
long faults_count(int kind);
long faults_failed();
int faults_kind(const char* name);
}

namespace faults {
namespace {

const char* const kNames[kKinds] = {"memory",     "map",      "open",      "open_read", "read",      "write",      "sync",      "rename",
                                    "link",       "close",    "folder",    "process",   "thread",    "send",       "gl_memory", "gl_map",
                                    "gl_program", "gl_fence", "gl_target", "gl_lost",   "cl_memory", "cl_command", "cl_build",  "cl_open"};

struct Range {
    uintptr_t begin, end;
};
constexpr int kMost = 16;
Range ours[kMost], passing[kMost];  // code of the module under test, and of libraries that pass failures on
int oursCount = 0, passingCount = 0;

using Counter = std::atomic<int64_t>;
Counter own[kKinds + 1];
Counter* counters = own;  // the last one: calls that failed
int armedKind = -1;
bool armedOnwards = false;
int64_t armedNumber = 0;
Counter armedSince = 0;  // the counter when it was armed

// Unwinding, or a call of ours inside another: not counted.
__attribute__((tls_model("initial-exec"))) thread_local bool inside = false;

bool in(const Range* ranges, int count, uintptr_t at) {
    for (int k = 0; k < count; ++k)
        if (at >= ranges[k].begin && at < ranges[k].end) return true;
    return false;
}

const char* baseName(const char* path) {
    const char* slash = std::strrchr(path, '/');
    return slash != nullptr ? slash + 1 : path;
}

// "librivulet.so" names librivulet.so.0.1 too.
bool isNamed(const char* name, const char* wanted) {
    const size_t length = std::strlen(wanted);
    return std::strncmp(name, wanted, length) == 0 && (name[length] == '\0' || name[length] == '.');
}

int noteModule(dl_phdr_info* info, size_t, void* wanted) {
    const char* name = info->dlpi_name[0] != '\0' ? baseName(info->dlpi_name) : program_invocation_short_name;
    bool passes = false;
    for (const char* library : {"libstdc++.so", "libc.so", "libfmt.so", "libjsoncpp.so"}) passes = passes || isNamed(name, library);
    const bool tested = isNamed(name, static_cast<const char*>(wanted));
    if (!passes && !tested) return 0;
    for (int k = 0; k < info->dlpi_phnum; ++k) {
        const ElfW(Phdr)& part = info->dlpi_phdr[k];
        if (part.p_type != PT_LOAD || (part.p_flags & PF_X) == 0) continue;
        Range* const list = tested ? ours : passing;
        int& count = tested ? oursCount : passingCount;
        const uintptr_t begin = info->dlpi_addr + part.p_vaddr;
        if (count < kMost) list[count++] = {begin, begin + part.p_memsz};
    }
    return 0;
}

struct Walk {
    int frames = 0;
    bool ours = false;
};

_Unwind_Reason_Code look(_Unwind_Context* context, void* data) {
    auto* const walk = static_cast<Walk*>(data);
    const auto at = static_cast<uintptr_t>(_Unwind_GetIP(context));
    // The first frames are the interposer's own, which is neither.
    if (walk->frames == 0 && !in(passing, passingCount, at)) return _URC_NO_REASON;
    if (++walk->frames > 40) return _URC_END_OF_STACK;
    if (in(passing, passingCount, at)) return _URC_NO_REASON;
    walk->ours = in(ours, oursCount, at);
    return _URC_END_OF_STACK;
}

bool isOurs(const void* caller) {
    const auto at = reinterpret_cast<uintptr_t>(caller);
    if (in(ours, oursCount, at)) return true;
    if (!in(passing, passingCount, at)) return false;
    Walk walk;
    _Unwind_Backtrace(look, &walk);
    return walk.ours;
}

void shareCounters(const char* path) {
    const size_t bytes = sizeof own;
    const int file = ::open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    if (file < 0) return;
    if (ftruncate(file, static_cast<off_t>(bytes)) == 0) {
        void* const at = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
        if (at != MAP_FAILED) counters = static_cast<Counter*>(at);
    }
    ::close(file);
}

struct Inside {
    Inside() { inside = true; }
    ~Inside() { inside = false; }
};

__attribute__((constructor)) void begin() {
    const char* const module = std::getenv("RIVULET_FAULT_MODULE");
    if (module == nullptr) return;
    const Inside guard;
    dl_iterate_phdr(noteModule, const_cast<char*>(module));
    if (oursCount == 0) return;  // another program, started by the one under test
    if (const char* counts = std::getenv("RIVULET_FAULT_COUNTS")) shareCounters(counts);
    const char* const fault = std::getenv("RIVULET_FAULT");
    const char* const colon = fault != nullptr ? std::strchr(fault, ':') : nullptr;
    if (colon == nullptr) return;
    for (int kind = 0; kind < kKinds; ++kind)
        if (std::strlen(kNames[kind]) == static_cast<size_t>(colon - fault) &&
            std::strncmp(fault, kNames[kind], static_cast<size_t>(colon - fault)) == 0)
            faults_arm(kind, std::strtol(colon + 1, nullptr, 10), std::strchr(colon, '+') != nullptr);
}

}  // namespace

bool fails(Kind kind, const void* caller) {
    if (oursCount == 0 || inside) return false;
    const Inside guard;
    if (!isOurs(caller)) return false;
    const int64_t number = counters[kind].fetch_add(1, std::memory_order_relaxed) + 1 - armedSince.load(std::memory_order_relaxed);
    if (kind != armedKind || (armedOnwards ? number < armedNumber : number != armedNumber)) return false;
    counters[kKinds].fetch_add(1, std::memory_order_relaxed);
    return true;
}

bool failed(Kind kind) { return kind == armedKind && counters[kKinds].load(std::memory_order_relaxed) > 0; }

}  // namespace faults

using namespace faults;

extern "C" {

void faults_arm(int kind, long number, int onwards) {
    armedKind = -1;
    counters[kKinds] = 0;
    if (kind < 0 || kind >= kKinds) return;
    armedNumber = number;
    armedOnwards = onwards != 0;
    armedSince = counters[kind].load();
    armedKind = kind;
}

long faults_count(int kind) { return static_cast<long>(counters[kind].load()); }
long faults_failed() { return static_cast<long>(counters[kKinds].load()); }
int faults_kind(const char* name) {
    for (int kind = 0; kind < kKinds; ++kind)
        if (std::strcmp(name, kNames[kind]) == 0) return kind;
    return -1;
}

}  // extern "C"
