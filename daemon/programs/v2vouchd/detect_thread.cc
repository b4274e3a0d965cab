// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/v2vouchd/detect_thread.h"

#include <sys/resource.h>
#include <unistd.h>

#include <utility>

namespace v2vouch {
namespace {

constexpr int kNice = 10;

}  // namespace

DetectThread::DetectThread(const wire::InputDecoder& decoder, ObjectDetector* detector,
                           MessageQueue& queue)
    : decoder_(decoder), detector_(detector), queue_(queue), thread_([this] { Run(); }) {}

DetectThread::~DetectThread() {
  {
    const std::lock_guard lock(mutex_);
    must_stop_ = true;
  }
  has_some_.notify_one();
  thread_.join();
}

void DetectThread::Offer(Arrival picture) {
  {
    const std::lock_guard lock(mutex_);
    Slot& slot = slots_[picture.channel];
    if (slot.picture) ++replaced_;
    slot.picture = std::move(picture);
  }
  has_some_.notify_one();
}

std::int64_t DetectThread::replaced() const {
  const std::lock_guard lock(mutex_);
  return replaced_;
}

void DetectThread::Run() {
  // Linux keeps a nice value per thread. Where it may not be set, the network competes.
  static_cast<void>(setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kNice));
  std::unique_lock lock(mutex_);
  while (true) {
    std::optional<Arrival> picture;
    has_some_.wait(lock, [&] { return must_stop_ || (picture = NextPicture()); });
    if (must_stop_) return;
    lock.unlock();
    picture->content = Look(*picture);
    const auto now = std::chrono::steady_clock::now();
    picture->looked = now - picture->arrived;
    picture->arrived = now;
    queue_.PushOwn(std::move(*picture));
    lock.lock();
  }
}

std::optional<Arrival> DetectThread::NextPicture() {
  Slot* next = nullptr;
  for (auto& [channel, slot] : slots_) {
    if (slot.picture && (next == nullptr || slot.last_look < next->last_look)) next = &slot;
  }
  if (next == nullptr) return std::nullopt;
  next->last_look = ++turn_;
  return std::exchange(next->picture, std::nullopt);
}

Arrival::Content DetectThread::Look(const Arrival& picture) {
  if (const auto* refusal = std::get_if<Refusal>(&picture.content)) return *refusal;
  const auto* bytes = std::get_if<Arrival::Bytes>(&picture.content);
  const auto channel = decoder_.Find(picture.channel);
  if (bytes == nullptr || !channel) return Reason::kUnknownChannel;
  RefusalTally unused;
  const auto decoded = decoder_.Decode(*channel, *bytes, picture.received, unused);
  if (!decoded) return decoded.refusal();
  const auto* image = std::get_if<CameraImage>(&*decoded);
  if (image == nullptr || detector_ == nullptr) return Reason::kNoDetector;
  try {
    auto detections = detector_->Detect(*image);
    if (!detections) return detections.refusal();
    return std::move(*detections);
  } catch (const std::exception&) {  // A library's way of saying that it cannot read this picture.
    return Reason::kBadImage;
  }
}

}  // namespace v2vouch
