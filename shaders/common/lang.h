// The only file that depends on which compiler reads a kernel: C++ (8 particles in 8 lanes), OpenCL C 1.2 or GLSL 4.5.
// `real` and `real3` hold values of the current particle: one float on a GPU, 8 floats (one lane for each particle) on the CPU.
// ARGS(RO, RW) is a kernel's interface. Each row RO|RW(number, BlockName, type, name) is a buffer; a comment gives its unit and meaning.
// Rows count from 1, to 8 at most: OpenGL guarantees no more buffers. BUFFERS follows it; functions that read a buffer come after BUFFERS
// and take GLOBAL(type, name). The line above KERNEL gives the forms that the build compiles for the cpu
// (engine/compute/compile_kernels.cmake registers them):
//   // cpu 1024                                one; a task of the thread pool runs 1024 threads
//   // cpu 64: MATTER? PERIODIC? | THESIS      five: with and without each of two defines; or with a third alone
//   // gpu only                                none
#if defined(__cplusplus)
#include "shaders/common/lang_cpp.h"
#elif defined(__OPENCL_C_VERSION__)
typedef float2 vec2;
typedef float3 vec3;
typedef float4 vec4;
typedef int3 ivec3;
typedef uint4 uvec4;
typedef float real;
typedef float3 real3;
typedef float4 real4;
/* GNU's form: NVIDIA's OpenCL refuses __VA_ARGS__. */
#define vec2(args...) ((float2)(args))
#define vec3(args...) ((float3)(args))
#define real3(args...) ((float3)(args))
#define vec4(args...) ((float4)(args))
#define ivec3(args...) ((int3)(args))
#undef abs
#define abs(x) fabs(x) /* of floats only, in every kernel */
#define TO_IVEC3(v) convert_int3(v)
#define TO_VEC3(v) convert_float3(v)
#define TO_INT(x) ((int)(x))
#define TO_UINT(x) ((uint)(x))
#define TO_FLOAT(x) ((float)(x))
#define TO_DOUBLE(x) ((double)(x))
#define CONSTANT(T, n, v) __constant T n = v
// Before a declaration: its value is computed as written, without contraction; in OpenCL a pragma does this, see voxel/crossing.h.
#define EXACT
#define FLOAT_BITS(f) as_uint(f)
#define BITS_FLOAT(u) as_float(u)
#define ATOMIC_ADD(x, v) atomic_add(&(x), v)
#define ATOMIC_MIN(x, v) atomic_min(&(x), v)
#define ATOMIC_MAX(x, v) atomic_max(&(x), v)
#define ATOMIC_OR(x, v) atomic_or(&(x), v)
#define ATOMIC_EXCHANGE(x, v) atomic_xchg(&(x), v) /* on GPUs only */
#define ATOMIC_READ(x) atomic_add(&(x), 0u)
#define LOWEST_BIT(u) (31u - clz((u) & (0u - (u)))) /* the number of the lowest bit that is set; u is not 0 */
#define PREFETCH(x) /* of memory that is read soon; for a CPU, whose few threads wait for it */
#define FN static inline
#define STRUCT(n)       \
    typedef struct n n; \
    struct n
#define GLOBAL(T, n) __global const T *n,
#define PASS(n) n,
#define RO(b, N, T, n) , __global const T* restrict n
#define RW(b, N, T, n) , __global T* restrict n
#define BUFFERS(P)
#define SHARED_OUT(T, n, count)                    /* GLSL declares work-group memory outside the kernel ... */
#define SHARED_IN(T, n, count) __local T n[count]; /* ... OpenCL inside it */
#define KERNEL(name, P) __kernel __attribute__((reqd_work_group_size(LOCAL_SIZE, 1, 1))) void name(__constant P* params_ ARGS(RO, RW))
#define PARAMS (*params_)
#define THREAD_ID ((uint)get_global_id(0))
#define LOCAL_ID ((uint)get_local_id(0))
#define GROUP_ID ((uint)get_group_id(0))
#define BARRIER barrier(CLK_LOCAL_MEM_FENCE)
#else  // GLSL. LOCAL_SIZE comes from the device, here and in OpenCL.
#define real float
#define real3 vec3
#define real4 vec4
#define TO_IVEC3(v) ivec3(v)
#define TO_VEC3(v) vec3(v)
#define TO_INT(x) int(x)
#define TO_UINT(x) uint(x)
#define TO_FLOAT(x) float(x)
#define TO_DOUBLE(x) double(x)
#define CONSTANT(T, n, v) const T n = v
#define EXACT precise
#define FLOAT_BITS(f) floatBitsToUint(f)
#define BITS_FLOAT(u) uintBitsToFloat(u)
#define ATOMIC_ADD(x, v) atomicAdd(x, v)
#define ATOMIC_MIN(x, v) atomicMin(x, v)
#define ATOMIC_MAX(x, v) atomicMax(x, v)
#define ATOMIC_OR(x, v) atomicOr(x, v)
#define ATOMIC_EXCHANGE(x, v) atomicExchange(x, v)
#define ATOMIC_READ(x) atomicAdd(x, 0u)
#define LOWEST_BIT(u) uint(findLSB(u))
#define PREFETCH(x)
#define FN
#define STRUCT(n) struct n
#define GLOBAL(T, n)
#define PASS(n)
#define RO(b, N, T, n) \
    layout(std430, binding = (b)-1) readonly buffer N { T n[]; };
#define RW(b, N, T, n) \
    layout(std430, binding = (b)-1) buffer N { T n[]; };
#define BUFFERS(P)                                                 \
    layout(local_size_x = LOCAL_SIZE) in;                          \
    layout(std140, binding = 0) uniform ParamBlock { P params_; }; \
    uniform uint groupBase_;                                       \
    ARGS(RO, RW)
#define SHARED_OUT(T, n, count) shared T n[count];
#define SHARED_IN(T, n, count)
#define KERNEL(name, P) void main()
#define PARAMS params_
// A dispatch has at most 65535 groups: device gl splits larger ones.
#define THREAD_ID (gl_GlobalInvocationID.x + groupBase_ * LOCAL_SIZE)
#define LOCAL_ID gl_LocalInvocationID.x
#define GROUP_ID (gl_WorkGroupID.x + groupBase_)
#define BARRIER                \
    {                          \
        memoryBarrierShared(); \
        barrier();             \
    }
#endif
#if !defined(__cplusplus)  // on a GPU a lane is the particle itself
// Whether a sum of squares is below `limit`, and not NaN: by its bits, since compilers for GPUs may take !(NaN < y) as NaN >= y.
#define SQUARE_BELOW(x, limit) (FLOAT_BITS(x) < FLOAT_BITS(limit))
#define SELECT(condition, a, b) ((condition) ? (a) : (b))
#define ANY_LANE(condition) (condition)
#define NEIGHBOR_TYPE uint  // see fluid/grid/neighbors.h
#define NEIGHBORS_KEPT(b, RO, RW) RW(b, Neighbors, NEIGHBOR_TYPE, neighbors)
#define LOAD(b, i) b[i]
#define LOAD3(b, i) b[i].xyz
#define LOADX(b, i) b[i].x
#define LOADY(b, i) b[i].y
#define LOADZ(b, i) b[i].z
#define LOADW(b, i) b[i].w
#define LOAD4_AT(b, i, offset) b[(i) + (offset)]
#define STORE(b, i, v) b[i] = (v)
#define STORE4(b, i, v, w) b[i] = vec4(v, w)
#define STORE4_AT(b, i, offset, v, w) b[(i) + (offset)] = vec4(v, w)
#define max0(x) max(x, 0.0f)
#endif
