// File: call_event.h
//
// CallEvent: a completion queue returns it when an operation is complete. The
// operation carries its tag():
//
//   class Call {
//     void Start() { stream.Read(&message, read_done_.tag()); }
//     void OnRead(bool ok);
//     MemberEvent<Call> read_done_{this, &Call::OnRead};
//   };
//   void OnNext(void* tag, bool ok) {  // what the queue returned
//     static_cast<CallEvent*>(tag)->OnEvent(ok);
//   }
//
// Must live until the queue has returned it. Not thread-safe.
#pragma once

namespace tactus::internal {

class CallEvent {
 public:
  // `ok` comes from the queue: false if the operation failed.
  virtual void OnEvent(bool ok) = 0;
  void* tag() { return this; }

 protected:
  ~CallEvent() = default;
};

// Calls a member function of the call that owns it.
template <typename Call>
class MemberEvent final : public CallEvent {
 public:
  using Handler = void (Call::*)(bool ok);
  MemberEvent(Call* call, Handler handler) : call_(call), handler_(handler) {}
  void OnEvent(bool ok) override { (call_->*handler_)(ok); }

 private:
  Call* const call_;
  const Handler handler_;
};

}  // namespace tactus::internal
