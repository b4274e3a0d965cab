// SPDX-License-Identifier: Apache-2.0
#include "daemon/app/detect_thread.h"

#include <utility>

namespace v2vouch {

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
    if (slots_.contains(picture.channel)) ++replaced_;
    std::string channel = picture.channel;
    slots_.insert_or_assign(std::move(channel), std::move(picture));
  }
  has_some_.notify_one();
}

std::int64_t DetectThread::replaced() const {
  const std::lock_guard lock(mutex_);
  return replaced_;
}

void DetectThread::Run() {
  std::unique_lock lock(mutex_);
  while (true) {
    has_some_.wait(lock, [this] { return must_stop_ || !slots_.empty(); });
    if (must_stop_) return;
    Arrival picture = std::move(slots_.begin()->second);
    slots_.erase(slots_.begin());
    lock.unlock();
    picture.content = Look(picture);
    queue_.PushOwn(std::move(picture));
    lock.lock();
  }
}

Arrival::Content DetectThread::Look(const Arrival& picture) {
  const auto* bytes = std::get_if<Arrival::Bytes>(&picture.content);
  const auto channel = decoder_.Find(picture.channel);
  if (bytes == nullptr || !channel) return Reason::kUnknownChannel;
  ReasonCounts unused{};
  const auto decoded = decoder_.Decode(*channel, *bytes, picture.received, unused);
  if (!decoded) return decoded.reason();
  const auto* image = std::get_if<CameraImage>(&*decoded);
  if (image == nullptr || detector_ == nullptr) return Reason::kNoDetector;
  try {
    auto detections = detector_->Detect(*image);
    if (!detections) return detections.reason();
    return std::move(*detections);
  } catch (const std::exception&) {  // A library's way of saying that it cannot read this picture.
    return Reason::kBadImage;
  }
}

}  // namespace v2vouch
