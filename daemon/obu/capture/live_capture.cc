// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/capture/live_capture.h"

#include <pcap/pcap.h>

#include <utility>

namespace v2vouch::obu {
namespace {

constexpr int kMost = 64;
constexpr int kReadTimeout_ms = 10;

struct Take {
  const std::function<void(const Captured&)>* sink;
  int link_type;
};

void OnPacket(unsigned char* user, const pcap_pkthdr* header, const unsigned char* bytes) {
  const auto* take = reinterpret_cast<const Take*>(user);
  Captured captured;
  captured.utime = static_cast<std::int64_t>(header->ts.tv_sec) * 1000000 + header->ts.tv_usec;
  captured.link_type = take->link_type;
  captured.bytes = Bytes(bytes, header->caplen);
  captured.is_cut = header->caplen < header->len;
  (*take->sink)(captured);
}

}  // namespace

struct LiveCapture::Handle {
  pcap_t* pcap = nullptr;
  int link_type = 0;
  ~Handle() {
    if (pcap != nullptr) pcap_close(pcap);
  }
};

std::unique_ptr<LiveCapture> LiveCapture::Open(const std::string& interface,
                                               const std::string& filter, int buffer_bytes,
                                               std::string& error) {
  char text[PCAP_ERRBUF_SIZE] = "";
  auto handle = std::make_unique<Handle>();
  handle->pcap = pcap_create(interface.c_str(), text);
  pcap_t* const pcap = handle->pcap;
  if (pcap == nullptr) {
    error = "interface " + interface + ": " + text;
    return nullptr;
  }
  pcap_set_snaplen(pcap, static_cast<int>(kLongestDatagram) + 256);
  pcap_set_promisc(pcap, 1);
  pcap_set_timeout(pcap, kReadTimeout_ms);
  pcap_set_immediate_mode(pcap, 1);
  pcap_set_buffer_size(pcap, buffer_bytes);
  const auto fail = [&]() -> std::unique_ptr<LiveCapture> {
    error = "interface " + interface + ": " + pcap_geterr(pcap);
    return nullptr;
  };
  // Warnings (promiscuous mode refused) are above 0.
  if (const int state = pcap_activate(pcap); state < 0) {
    if (state == PCAP_ERROR_NO_SUCH_DEVICE || state == PCAP_ERROR_PERM_DENIED) {
      error = "interface " + interface + ": " + pcap_statustostr(state);
      return nullptr;
    }
    return fail();
  }
  if (!filter.empty()) {
    bpf_program program{};
    if (pcap_compile(pcap, &program, filter.c_str(), 1, PCAP_NETMASK_UNKNOWN) != 0) return fail();
    const bool is_set = pcap_setfilter(pcap, &program) == 0;
    pcap_freecode(&program);
    if (!is_set) return fail();
  }
  if (pcap_setnonblock(pcap, 1, text) != 0) {
    error = "interface " + interface + ": " + text;
    return nullptr;
  }
  handle->link_type = pcap_datalink(pcap);
  return std::unique_ptr<LiveCapture>(new LiveCapture(std::move(handle)));
}

LiveCapture::LiveCapture(std::unique_ptr<Handle> handle) : handle_(std::move(handle)) {}
LiveCapture::~LiveCapture() = default;

int LiveCapture::Receive(const std::function<void(const Captured&)>& sink) {
  Take take{&sink, handle_->link_type};
  return pcap_dispatch(handle_->pcap, kMost, OnPacket, reinterpret_cast<unsigned char*>(&take));
}

int LiveCapture::descriptor() const { return pcap_get_selectable_fd(handle_->pcap); }

std::int64_t LiveCapture::drops() const {
  pcap_stat statistics{};
  if (pcap_stats(handle_->pcap, &statistics) != 0) return 0;
  return std::int64_t{statistics.ps_drop} + statistics.ps_ifdrop;
}

}  // namespace v2vouch::obu
