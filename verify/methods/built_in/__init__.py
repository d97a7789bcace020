"""Built-in methods: a file with a frozen `Method` is one, or with a tuple of them; `verify.methods.names` finds it."""
