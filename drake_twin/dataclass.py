"""``dataclass`` as the standard library's, made without compiling the methods of each class when it is imported.

The standard library writes each method as text and compiles it, 0.5 ms for a frozen class: a sixth of a whole start,
for classes of which it uses less than half. Here ``__init__`` is compiled when it is first looked up, and the others
are closures, which take as long as compiled ones. `dataclasses.fields`, `dataclasses.replace`, … know no difference.
"""

import dataclasses
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from dataclasses import dataclass as dataclass
else:
    from functools import partial
    from operator import attrgetter
    from reprlib import recursive_repr

    _MISSING, _GIVEN_BY_FACTORY = dataclasses.MISSING, dataclasses._HAS_DEFAULT_FACTORY

    def dataclass(cls=None, /, **options):
        """Make a dataclass, as `dataclasses.dataclass` does; ``InitVar`` is not known."""
        if cls is None:
            return partial(dataclass, **options)
        if options.keys() - {"frozen", "kw_only"} or any(map(dataclasses.is_dataclass, cls.__mro__[1:])):
            return dataclasses.dataclass(cls, **options)
        is_frozen = options.pop("frozen", False)
        own = vars(cls)
        has_hash = own.get("__hash__") is not None or ("__hash__" in own and "__eq__" not in own)
        cls.__doc__ = cls.__doc__ or cls.__name__  # else it is written from the signature
        dataclasses.dataclass(cls, init=False, repr=False, eq=False, **options)
        params = cls.__dataclass_params__  # what a subclass must be like
        params.init = params.repr = params.eq = True
        params.frozen = is_frozen
        fields = dataclasses.fields(cls)
        methods = {
            "__init__": _Init(cls, is_frozen),
            "__repr__": _repr([field.name for field in fields if field.repr]),
            "__eq__": _eq(_values([field.name for field in fields if field.compare])),
        }
        if is_frozen:
            methods |= _refusing(cls, {field.name for field in fields})
            hashed = [field.name for field in fields if (field.compare if field.hash is None else field.hash)]
        if not has_hash:
            cls.__hash__ = _hash(_values(hashed)) if is_frozen else None
        for name, method in methods.items():
            if name not in own:
                method.__name__, method.__qualname__ = name, f"{cls.__qualname__}.{name}"
                setattr(cls, name, method)
        return cls

    class _Init:
        """Stands for a class's ``__init__`` until it is first looked up, and is replaced by it then."""

        def __init__(self, cls, is_frozen):
            self._cls, self._is_frozen = cls, is_frozen

        def __get__(self, instance, owner=None):
            self._cls.__init__ = init = _init(self._cls, self._is_frozen)
            init.__qualname__ = self.__qualname__
            return init.__get__(instance, owner)

    def _init(cls, is_frozen):
        """Compile a class's ``__init__``."""
        names = {"_set_": object.__setattr__, "_by_factory_": _GIVEN_BY_FACTORY}
        first, by_name, lines = [], [], []
        for field in dataclasses.fields(cls):
            name = value = field.name
            parameter = name
            if field.default_factory is not _MISSING:
                names[f"_factory_{name}_"] = field.default_factory
                parameter, value = f"{name}=_by_factory_", f"_factory_{name}_()"
                if field.init:
                    value += f" if {name} is _by_factory_ else {name}"
            elif field.default is not _MISSING:
                names[f"_default_{name}_"] = field.default
                parameter = f"{name}=_default_{name}_"
            if field.init:
                (by_name if field.kw_only else first).append(parameter)
            elif field.default_factory is _MISSING:
                continue
            lines.append(f"_set_(self, {name!r}, {value})" if is_frozen else f"self.{name} = {value}")
        if hasattr(cls, "__post_init__"):
            lines.append("self.__post_init__()")
        parameters = ", ".join(["self", *first, *(["*", *by_name] if by_name else [])])
        exec(f"def __init__({parameters}):\n " + "\n ".join(lines or ["pass"]), names)
        init = names["__init__"]
        init.__module__ = cls.__module__
        init.__annotations__ = {field.name: field.type for field in dataclasses.fields(cls) if field.init}
        init.__annotations__["return"] = None
        return init

    def _values(names):
        """Return a function that returns an instance's values as a tuple."""
        if len(names) > 1:
            return attrgetter(*names)
        return (lambda instance: (getattr(instance, names[0]),)) if names else lambda instance: ()

    def _repr(names):
        @recursive_repr()
        def described(self):
            return f"{type(self).__qualname__}({', '.join(f'{name}={getattr(self, name)!r}' for name in names)})"

        return described

    def _eq(values):
        def equals(self, other):
            return values(self) == values(other) if other.__class__ is self.__class__ else NotImplemented

        return equals

    def _hash(values):
        return lambda instance: hash(values(instance))

    def _refusing(cls, names):
        """Return methods that refuse to set or delete the fields of a frozen class."""

        def set_it(self, name, value):
            if type(self) is cls or name in names:
                raise dataclasses.FrozenInstanceError(f"cannot assign to field {name!r}")
            super(cls, self).__setattr__(name, value)

        def delete_it(self, name):
            if type(self) is cls or name in names:
                raise dataclasses.FrozenInstanceError(f"cannot delete field {name!r}")
            super(cls, self).__delattr__(name)

        return {"__setattr__": set_it, "__delattr__": delete_it}
