"""A wire that ends in the same process."""


class LocalSender:
    """Keeps what is sent."""

    def __init__(self, topic, listened):
        self.topic, self.listened = topic, listened
        self.is_heard = topic.latched
        self.sent = []
        self.is_closed = False

    def send(self, data, time):
        self.sent.append((data, time))

    def close(self):
        self.is_closed = True


class LocalEnd:
    """An end of a topic or a service that the twin hears."""

    def __init__(self, endpoint, call):
        self.endpoint, self.call = endpoint, call
        self.is_closed = False

    def close(self):
        self.is_closed = True


class LocalWire:
    """Its ends by their names."""

    def __init__(self):
        self.senders, self.listeners, self.services = {}, {}, {}
        self.is_closed = False

    def advertise(self, topic, listened):
        return self.senders.setdefault(topic.name, LocalSender(topic, listened))

    def listen(self, topic, heard):
        return self.listeners.setdefault(topic.name, LocalEnd(topic, heard))

    def serve(self, service, answer):
        return self.services.setdefault(service.name, LocalEnd(service, answer))

    def close(self):
        self.is_closed = True

    def hear(self, topic, is_heard=True):
        """Says that somebody listens to a topic."""
        sender = self.senders[topic]
        sender.is_heard = is_heard
        sender.listened(is_heard)
        return sender.sent
