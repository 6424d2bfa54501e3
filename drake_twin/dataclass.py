"""``dataclass`` as the standard library's, whose methods are compiled when they are first looked up.

The standard library writes the methods of each class as text and compiles them when its module is imported, 0.5 ms for
a frozen class: a sixth of a whole start, which calls few of them. `dataclasses.fields`, `dataclasses.replace`,
`inspect.signature` and classes that inherit from one find what they look for.
"""

import dataclasses
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from dataclasses import dataclass as dataclass
else:
    from functools import partial
    from reprlib import recursive_repr

    def dataclass(cls=None, /, **options):
        """Make a dataclass, as `dataclasses.dataclass` does; ``InitVar`` is not known."""
        if cls is None:
            return partial(dataclass, **options)
        if options.keys() - {"frozen", "kw_only"}:
            return dataclasses.dataclass(cls, **options)
        is_frozen = options.pop("frozen", False)
        inherits = any(map(dataclasses.is_dataclass, cls.__mro__[1:]))
        own = {**vars(cls)}
        cls.__doc__ = cls.__doc__ or cls.__name__  # else it is written from the signature
        # One that inherits has to be frozen as its base is, of which the standard library makes sure.
        dataclasses.dataclass(cls, init=False, repr=False, eq=False, frozen=is_frozen and inherits, **options)
        params = cls.__dataclass_params__  # which say how the classes that inherit from it have to be
        params.init = params.repr = params.eq = True
        params.frozen = is_frozen
        for name, write in (("__init__", _init), ("__repr__", _repr), ("__eq__", _eq)):
            if name not in own:
                setattr(cls, name, _Method(cls, name, write))
        if own.get("__hash__") is None and ("__hash__" not in own or "__eq__" in own):
            cls.__hash__ = _Method(cls, "__hash__", _hash) if is_frozen else None
        if is_frozen and not inherits:
            _freeze(cls)
        return cls

    class _Method:
        """Stands for a method of a class until it is looked up, and is replaced by it then, in any thread."""

        def __init__(self, cls, name, write):
            self._cls, self._name, self._write = cls, name, write

        def __get__(self, instance, owner=None):
            cls, name = self._cls, self._name
            method = self._write(cls)
            method.__name__, method.__qualname__, method.__module__ = name, f"{cls.__qualname__}.{name}", cls.__module__
            setattr(cls, name, method)
            return method.__get__(instance, owner)

    class _ByFactory:
        """The default of a value that a factory makes."""

        def __repr__(self):
            return "<factory>"

    def _compiled(parameters, lines, names=None):
        names = {} if names is None else names
        exec(f"def method({', '.join(parameters)}):\n " + "\n ".join(lines), names)
        return names["method"]

    def _init(cls):
        names = {"_set_": object.__setattr__, "_by_factory_": _ByFactory()}
        first, by_name, lines = ["self"], [], []
        for field in dataclasses.fields(cls):
            name = parameter = value = field.name
            if field.default is not dataclasses.MISSING:
                parameter, names[f"_default_{name}_"] = f"{name}=_default_{name}_", field.default
            elif field.default_factory is not dataclasses.MISSING:
                parameter, names[f"_factory_{name}_"] = f"{name}=_by_factory_", field.default_factory
                value = f"_factory_{name}_()" + (f" if {name} is _by_factory_ else {name}" if field.init else "")
            if field.init:
                (by_name if field.kw_only else first).append(parameter)
            if field.init or value != name:
                is_frozen = cls.__dataclass_params__.frozen
                lines.append(f"_set_(self, {name!r}, {value})" if is_frozen else f"self.{name} = {value}")
        if hasattr(cls, "__post_init__"):
            lines.append("self.__post_init__()")
        method = _compiled([*first, *(["*", *by_name] if by_name else [])], lines or ["pass"], names)
        types = {field.name: field.type for field in dataclasses.fields(cls) if field.init}
        method.__annotations__ = {**types, "return": None}
        return method

    def _repr(cls):
        values = ", ".join(f"{field.name}={{self.{field.name}!r}}" for field in dataclasses.fields(cls) if field.repr)
        return recursive_repr()(_compiled(["self"], [f'return f"{{self.__class__.__qualname__}}({values})"']))

    def _eq(cls):
        names = [field.name for field in dataclasses.fields(cls) if field.compare]
        same = f"{_values('self', names)} == {_values('other', names)}"
        return _compiled(["self", "other"], [f"return {same} if other.__class__ is self.__class__ else NotImplemented"])

    def _hash(cls):
        fields = dataclasses.fields(cls)
        names = [field.name for field in fields if (field.compare if field.hash is None else field.hash)]
        return _compiled(["self"], [f"return hash({_values('self', names)})"])

    def _values(instance, names):
        return "(" + "".join(f"{instance}.{name}, " for name in names) + ")"

    def _freeze(cls):
        names = {field.name for field in dataclasses.fields(cls)}

        def set_it(self, name, value):
            if type(self) is cls or name in names:
                raise dataclasses.FrozenInstanceError(f"cannot assign to field {name!r}")
            super(cls, self).__setattr__(name, value)

        def delete_it(self, name):
            if type(self) is cls or name in names:
                raise dataclasses.FrozenInstanceError(f"cannot delete field {name!r}")
            super(cls, self).__delattr__(name)

        cls.__setattr__, cls.__delattr__ = set_it, delete_it
