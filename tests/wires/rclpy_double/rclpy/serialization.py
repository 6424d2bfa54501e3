"""Messages of the double are their bytes."""


def serialize_message(message):
    """Return a message's bytes."""
    return message.data


def deserialize_message(data, kind):
    """Return the message of bytes."""
    return kind(data)
