// File: limits_http2.h
//
// The limits of HTTP/2 connections, beside those of limits.h: what passes
// before gRPC parses it (core/http2), and how long a connection may be stuck.
#pragma once

#include <cstddef>
#include <cstdint>

namespace tactus::internal::limits {

// A header block on the wire and decoded; gRPC itself answers a call with more
// than 16 KiB of metadata. Its frames and its headers.
inline constexpr size_t kMaxHeaderBlockBytes = 32 * 1024;
inline constexpr int kMaxHeaderBlockFrames = 16;
inline constexpr int kMaxHeaders = 256;
// Frames that cost work and carry no message: at a steady rate and at once. The
// last are HEADERS, WINDOW_UPDATE and the like: a download makes
// its reader send some thousands of them per second.
inline constexpr double kHttp2SettingsPerSecond = 100;
inline constexpr double kHttp2SettingsBurst = 1'000;
inline constexpr double kHttp2PingsPerSecond = 100;
inline constexpr double kHttp2PingsBurst = 1'000;
// Calls that a client begins and resets (RST_STREAM). nghttp2 takes as many at
// once, and 33 per second.
inline constexpr double kHttp2ResetsPerSecond = 100;
inline constexpr double kHttp2ResetBurst = 1'000;
inline constexpr double kHttp2SmallFramesPerSecond = 20'000;
inline constexpr double kHttp2SmallFrameBurst = 100'000;
inline constexpr int kMaxHttp2GoAways = 4;
// Descriptors of connections that can be vetted; a larger one is refused.
inline constexpr int kMaxVettedDescriptors = 1 << 20;
// A connection is closed when its peer has taken none of the bytes that wait
// for it for this long, and how often the server looks.
inline constexpr int kUnreadTimeoutMs = 120'000;
inline constexpr int kUnreadLookMs = 5'000;

}  // namespace tactus::internal::limits
