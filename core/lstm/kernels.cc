#include "core/lstm/kernels.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <type_traits>

#include "core/lstm/vector_math.h"

namespace tactus::internal {
namespace {

// Rows of c kept in registers at once, and vectors of each: as many as the
// registers hold.
constexpr int kTileRows = 6;
template <int kLanes>
constexpr int kTileVectors = kLanes == 16 ? 4 : 2;
constexpr int kMaxRowVectors = 8;
// Number of terms summed before the next tile, so that their rows of b stay in
// the cache.
constexpr int kTileInner = 256;

template <int kLanes, int kRows, int kVectors>
TACTUS_INLINE void Tile(const LstmProduct& p) {
  using Floats = typename Lanes<kLanes>::Floats;
  Floats sums[kRows][kVectors];
#pragma GCC unroll 8
  for (int m = 0; m < kRows; ++m) {
#pragma GCC unroll 8
    for (int v = 0; v < kVectors; ++v) {
      Load(p.start + m * p.start_row + v * kLanes, sums[m][v]);
    }
  }
  const float* a = p.a;
  const float* b = p.b;
  for (int k = 0; k < p.inner; ++k) {
    Floats factors[kVectors];
#pragma GCC unroll 8
    for (int v = 0; v < kVectors; ++v) Load(b + v * kLanes, factors[v]);
#pragma GCC unroll 8
    for (int m = 0; m < kRows; ++m) {
      const float factor = a[m * p.a_row];
#pragma GCC unroll 8
      for (int v = 0; v < kVectors; ++v) sums[m][v] += factor * factors[v];
    }
    a += p.a_column;
    b += p.b_row;
  }
#pragma GCC unroll 8
  for (int m = 0; m < kRows; ++m) {
#pragma GCC unroll 8
    for (int v = 0; v < kVectors; ++v) {
      Store(sums[m][v], p.c + m * p.c_row + v * kLanes);
    }
  }
}

// All rows of `p`, kVectors vectors wide.
template <int kLanes, int kVectors>
TACTUS_INLINE void TileRows(LstmProduct p) {
  for (; p.rows >= kTileRows; p.rows -= kTileRows) {
    Tile<kLanes, kTileRows, kVectors>(p);
    p.a += kTileRows * p.a_row;
    p.start += kTileRows * p.start_row;
    p.c += kTileRows * p.c_row;
  }
  static_assert(kTileRows == 6);
  switch (p.rows) {
    case 5:
      return Tile<kLanes, 5, kVectors>(p);
    case 4:
      return Tile<kLanes, 4, kVectors>(p);
    case 3:
      return Tile<kLanes, 3, kVectors>(p);
    case 2:
      return Tile<kLanes, 2, kVectors>(p);
    case 1:
      return Tile<kLanes, 1, kVectors>(p);
    default:
      return;
  }
}

// A single row, in tiles of 5 to 8 vectors: with fewer, additions would wait
// for each other.
template <int kLanes>
TACTUS_INLINE void TileOneRow(LstmProduct p) {
  static_assert(kMaxRowVectors == 8);
  for (int vectors = p.columns / kLanes; vectors > 0;) {
    const int tiles = (vectors + kMaxRowVectors - 1) / kMaxRowVectors;
    const int width = (vectors + tiles - 1) / tiles;
    switch (width) {
      case 8:
        Tile<kLanes, 1, 8>(p);
        break;
      case 7:
        Tile<kLanes, 1, 7>(p);
        break;
      case 6:
        Tile<kLanes, 1, 6>(p);
        break;
      case 5:
        Tile<kLanes, 1, 5>(p);
        break;
      case 4:
        Tile<kLanes, 1, 4>(p);
        break;
      case 3:
        Tile<kLanes, 1, 3>(p);
        break;
      case 2:
        Tile<kLanes, 1, 2>(p);
        break;
      default:
        Tile<kLanes, 1, 1>(p);
    }
    vectors -= width;
    p.b += width * kLanes;
    p.start += width * kLanes;
    p.c += width * kLanes;
  }
}

template <int kLanes>
TACTUS_INLINE void Product(const LstmProduct& p) {
  constexpr int kVectors = kTileVectors<kLanes>;
  for (int from = 0; from < p.inner; from += kTileInner) {
    LstmProduct part = p;
    part.inner = std::min(kTileInner, p.inner - from);
    part.a += from * p.a_column;
    part.b += from * p.b_row;
    if (from > 0) {
      part.start = p.c;
      part.start_row = p.c_row;
    }
    if (p.rows == 1) {
      TileOneRow<kLanes>(part);
      continue;
    }
    const auto step_right = [&part](int columns) {
      part.columns -= columns;
      part.b += columns;
      part.start += columns;
      part.c += columns;
    };
    while (part.columns >= kVectors * kLanes) {
      TileRows<kLanes, kVectors>(part);
      step_right(kVectors * kLanes);
    }
    while (part.columns > 0) {
      TileRows<kLanes, 1>(part);
      step_right(kLanes);
    }
  }
}

// Calls step(lanes, j) for vectors of cells from j on: kLanes cells each, and
// in the end the narrowest vector that holds the rest.
template <int kLanes, typename Step>
TACTUS_INLINE void ForEachVector(int cells, const Step& step) {
  int j = 0;
  for (; cells - j >= kLanes; j += kLanes) {
    step(std::integral_constant<int, kLanes>(), j);
  }
  const int rest = cells - j;
  if (rest == 0) return;
  if (rest <= 4) return step(std::integral_constant<int, 4>(), j);
  if (kLanes > 8 && rest <= 8) {
    return step(std::integral_constant<int, std::min(kLanes, 8)>(), j);
  }
  step(std::integral_constant<int, kLanes>(), j);
}

template <int kLanes>
TACTUS_INLINE void CellForward(const LstmCellForward& f) {
  const LstmCellShape& s = f.shape;
  for (int row = 0; row < s.rows; ++row) {
    float* gates = f.gates + row * s.gate_row;
    ForEachVector<kLanes>(s.cells, [&](auto lanes, int j) TACTUS_INLINE_LAMBDA {
      using Floats = typename Lanes<lanes>::Floats;
      const ptrdiff_t at = row * s.cell_row + j;
      Floats i, forget, c, o, cell;
      Load(gates + j, i);
      Load(gates + s.cells + j, forget);
      Load(gates + 2 * s.cells + j, c);
      Load(gates + 3 * s.cells + j, o);
      Load(f.previous + at, cell);
      ActivateGate(s.gate_activation, i);
      ActivateGate(s.gate_activation, forget);
      Activate(s.activation, c);
      ActivateGate(s.gate_activation, o);
      Store(forget * cell + i * c, f.cell + at);
      // Until o is read below.
      Store(o, f.output + at);
      const int count = s.cells - j;
      StoreFirst(i, count, gates + j);
      StoreFirst(forget, count, gates + s.cells + j);
      StoreFirst(c, count, gates + 2 * s.cells + j);
      StoreFirst(o, count, gates + 3 * s.cells + j);
    });
    // A separate loop, because these values depend on the cells.
    ForEachVector<kLanes>(s.cells, [&](auto lanes, int j) TACTUS_INLINE_LAMBDA {
      using Floats = typename Lanes<lanes>::Floats;
      const ptrdiff_t at = row * s.cell_row + j;
      Floats squashed, o;
      Load(f.cell + at, squashed);
      Load(f.output + at, o);
      Activate(s.activation, squashed);
      Store(squashed, f.squashed + at);
      Store(o * squashed, f.output + at);
    });
  }
}

template <int kLanes>
TACTUS_INLINE void CellBackward(const LstmCellBackward& g) {
  const LstmCellShape& s = g.shape;
  for (int row = 0; row < s.rows; ++row) {
    const float* gates = g.gates + row * s.gate_row;
    float* deltas = g.deltas + row * s.gate_row;
    ForEachVector<kLanes>(s.cells, [&](auto lanes, int j) TACTUS_INLINE_LAMBDA {
      using Floats = typename Lanes<lanes>::Floats;
      const ptrdiff_t at = row * s.cell_row + j;
      Floats i, forget, c, o, previous, squashed, above, next, carry;
      Load(gates + j, i);
      Load(gates + s.cells + j, forget);
      Load(gates + 2 * s.cells + j, c);
      Load(gates + 3 * s.cells + j, o);
      Load(g.previous + at, previous);
      Load(g.squashed + at, squashed);
      Load(g.from_above + at, above);
      Load(g.from_next + at, next);
      Load(g.carry + at, carry);
      const Floats by_output = above + next;
      Floats by_cell = by_output * o;
      TimesSlope(s.activation, squashed, by_cell);
      by_cell += carry;
      Floats by_i = by_cell * c;
      Floats by_forget = by_cell * previous;
      Floats by_c = by_cell * i;
      Floats by_o = by_output * squashed;
      carry = by_cell * forget;
      TimesGateSlope(s.gate_activation, i, by_i);
      TimesGateSlope(s.gate_activation, forget, by_forget);
      TimesSlope(s.activation, c, by_c);
      TimesGateSlope(s.gate_activation, o, by_o);
      FlushTiny(carry);
      FlushTiny(by_i);
      FlushTiny(by_forget);
      FlushTiny(by_c);
      FlushTiny(by_o);
      Store(carry, g.carry + at);
      const int count = s.cells - j;
      StoreFirst(by_i, count, deltas + j);
      StoreFirst(by_forget, count, deltas + s.cells + j);
      StoreFirst(by_c, count, deltas + 2 * s.cells + j);
      StoreFirst(by_o, count, deltas + 3 * s.cells + j);
    });
  }
}

// The three kernels at `lanes` floats for CPUs with `target`.
#define TACTUS_KERNELS(Name, target, lanes)                                  \
  struct Name {                                                              \
    target static void Multiply(const LstmProduct& p) { Product<lanes>(p); } \
    target static void Forward(const LstmCellForward& step) {                \
      CellForward<lanes>(step);                                              \
    }                                                                        \
    target static void Backward(const LstmCellBackward& step) {              \
      CellBackward<lanes>(step);                                             \
    }                                                                        \
    static constexpr LstmKernels kKernels = {#Name, &Multiply, &Forward,     \
                                             &Backward};                     \
  };

TACTUS_KERNELS(Baseline, , 4)
#ifdef __x86_64__
TACTUS_KERNELS(Avx2, [[gnu::target("avx2")]], 8)
TACTUS_KERNELS(Avx512, [[gnu::target("avx512f")]], 16)
constexpr std::array kAll = {Baseline::kKernels, Avx2::kKernels,
                             Avx512::kKernels};
#else
constexpr std::array kAll = {Baseline::kKernels};
#endif

size_t CountSupported() {
#ifdef __x86_64__
  if (!__builtin_cpu_supports("avx2")) return 1;
  if (!__builtin_cpu_supports("avx512f")) return 2;
#endif
  return kAll.size();
}

}  // namespace

std::span<const LstmKernels> SupportedLstmKernels() {
  static const size_t count = CountSupported();
  return {kAll.data(), count};
}

const LstmKernels& BestLstmKernels() { return SupportedLstmKernels().back(); }

}  // namespace tactus::internal
